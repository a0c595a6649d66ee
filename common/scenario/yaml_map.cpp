// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/yaml_map.hpp"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <unordered_set>

#include "common/process/escaped.hpp"

namespace eti {

namespace {

constexpr int max_depth = 12;
constexpr int max_nodes = 10'000;
constexpr std::size_t longest_text = 500;
constexpr std::size_t longest_name = 60;  // the bus's limit is 64

std::string place(const std::string& file, const YAML::Mark& mark) {
    return mark.is_null() ? file : fmt::format("{}:{}", file, mark.line + 1);
}

/// Shortened for a message, without control characters.
std::string shortened(const std::string& value) {
    return escaped(value, max_shown_bytes);
}

std::string shown(const std::string& value) {
    return fmt::format("'{}'", shortened(value));
}

/// The line whose indentation contains a tab, or nullopt. YAML indents by spaces alone, and its parser's
/// message does not mention the tab.
std::optional<int> line_indented_by_tab(const std::string& text) {
    int number = 1;
    bool indenting = true, tab = false;
    for (const char letter : text) {
        if (letter == '\n') {
            ++number;
            indenting = true;
            tab = false;
        } else if (indenting && (letter == ' ' || letter == '\t')) {
            tab = tab || letter == '\t';
        } else {
            if (indenting && tab && letter != '\r') {
                return number;
            }
            indenting = false;
        }
    }
    return std::nullopt;
}

/// Walks the parser's events before any tree is built, and rejects constructs that make a small file large.
class Gate : public YAML::EventHandler {
  public:
    Gate(const std::string& text, const std::string& file) : text_(text), file_(file) {}
    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { check(mark, anchor); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string&) override {
        check(mark, anchor, tag);
        if (tag == "!") {
            check_closed(mark);
        }
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        enter(mark, anchor, tag);
    }
    void OnSequenceEnd() override { --depth_; }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        enter(mark, anchor, tag);
    }
    void OnMapEnd() override { --depth_; }

  private:
    // The parser tags plain values "?" and quoted ones "!".
    void check(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag = "?") {
        if (anchor != 0) {
            refuse(mark);
        }
        if (!tag.empty() && tag != "?" && tag != "!") {
            throw InputError(fmt::format("{}: found the tag {}, expected plain values; remove the tag",
                                         place(file_, mark), shown(tag)));
        }
        if (++nodes_ > max_nodes) {
            throw InputError(
                fmt::format("{}: more than {} values, expected at most that; is this the right file?",
                            place(file_, mark), max_nodes));
        }
    }
    // The parser treats the end of file as the closing quote, and would swallow the keys that follow.
    void check_closed(const YAML::Mark& mark) const {
        std::size_t i = static_cast<std::size_t>(mark.pos);
        if (i >= text_.size() || (text_[i] != '"' && text_[i] != '\'')) {
            return;
        }
        const char quote = text_[i++];
        for (; i < text_.size(); ++i) {
            // Escaped: \x in double quotes, '' in single ones.
            if (quote == '"' ? text_[i] == '\\' : text_.compare(i, 2, "''") == 0) {
                ++i;
            } else if (text_[i] == quote) {
                return;
            }
        }
        throw InputError(
            fmt::format("{}: found an unterminated quote; close it with {}", place(file_, mark), quote));
    }
    void enter(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag) {
        check(mark, anchor, tag);
        if (++depth_ > max_depth) {
            throw InputError(
                fmt::format("{}: nested deeper than {} levels, expected at most that; flatten the file",
                            place(file_, mark), max_depth));
        }
    }
    [[noreturn]] void refuse(const YAML::Mark& mark) const {
        throw InputError(fmt::format(
            "{}: found an anchor or alias ('&' or '*'), expected plain values; write the value out",
            place(file_, mark)));
    }
    const std::string& text_;
    const std::string& file_;
    int depth_ = 0;
    int nodes_ = 0;
};

/// Rejects text that is not UTF-8 before the YAML parser sees it; states the line.
void check_text(const std::string& text, const std::string& file) {
    if (text.starts_with("\xef\xbb\xbf")) {
        throw InputError(fmt::format(
            "{}:1: found a byte order mark, expected plain UTF-8; save the file without it", file));
    }
    int line = 1;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        line += byte == '\n';
        // Number of continuation bytes, from the leading byte's high bits.
        const int more = byte < 0x80           ? 0
                         : (byte >> 5) == 0x6  ? 1
                         : (byte >> 4) == 0xe  ? 2
                         : (byte >> 3) == 0x1e ? 3
                                               : -1;
        bool good =
            more >= 0 && (byte >= 0x20 || byte == '\n' || byte == '\r' || byte == '\t') && byte != 0x7f;
        for (int k = 0; good && k < more; ++k) {
            ++i;
            good = i < text.size() && (static_cast<unsigned char>(text[i]) >> 6) == 0x2;
        }
        if (!good) {
            throw InputError(
                fmt::format("{}:{}: found byte 0x{:02x}, which is not valid UTF-8, expected a text file; is "
                            "this the right file?",
                            file, line, byte));
        }
    }
}

/// Levenshtein distance: insertions, removals and replacements that turn one word into the other.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        row[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row[b.size()];
}

/// "; did you mean 'x'?" if a known word is close enough to be a typing error; else empty.
std::string guess(const std::string& word, std::span<const std::string> known) {
    const std::string* best = nullptr;
    std::size_t least = 4;  // more than three edits make it another word
    for (const std::string& candidate : known) {
        const std::size_t apart = word.size() < 64 ? distance(word, candidate) : least;
        if (apart < least && 2 * apart < candidate.size()) {
            least = apart;
            best = &candidate;
        }
    }
    return best ? fmt::format("; did you mean '{}'?", *best) : "";
}

}  // namespace

YamlMap::YamlMap(YAML::Node node, std::string file, std::string path, Descriptions described)
    : node_(std::move(node)),
      file_(std::move(file)),
      path_(std::move(path)),
      described_(std::move(described)) {
    if (!node_.IsMap()) {
        throw InputError(fmt::format("{}: {} is not a mapping, expected 'key: value' lines",
                                     place(file_, node_.Mark()),
                                     path_.empty() ? "the file" : "'" + path_ + "'"));
    }
    std::unordered_set<std::string> seen;
    for (const auto& entry : node_) {
        if (!entry.first.IsScalar()) {
            throw InputError(
                fmt::format("{}: found a list or mapping as a key, expected a word; write 'key: value'",
                            place(file_, entry.first.Mark())));
        }
        const std::string key = entry.first.Scalar();
        if (!seen.insert(key).second) {
            throw InputError(fmt::format("{}: key '{}{}' appears twice, expected once; remove one",
                                         place(file_, entry.first.Mark()), path_, shortened(key)));
        }
    }
}

YamlMap YamlMap::parse(const std::string& text, const std::string& file) {
    check_text(text, file);
    try {
        std::istringstream events(text);
        YAML::Parser parser(events);
        Gate gate(text, file);
        if (!parser.HandleNextDocument(gate)) {
            throw InputError(fmt::format("{}: the file is empty, expected 'key: value' lines", file));
        }
        if (parser.HandleNextDocument(gate)) {
            throw InputError(
                fmt::format("{}: found a second document ('---'), expected one; remove it", file));
        }
        return YamlMap(YAML::Load(text), file, "", std::make_shared<std::vector<KeyDescription>>());
    } catch (const YAML::Exception& error) {
        if (const auto line = line_indented_by_tab(text)) {
            throw InputError(
                fmt::format("{}:{}: found a tab in the indentation, expected spaces; replace tabs by spaces",
                            file, *line));
        }
        throw InputError(fmt::format("{}: not valid YAML: {}; correct the file there",
                                     place(file, error.mark), error.msg));
    }
}

void YamlMap::refuse(const std::string& key, const std::string& found, const std::string& expected) const {
    const YAML::Node value = node_[key];
    throw InputError(fmt::format("{}: key '{}{}': found {}, expected {}",
                                 place(file_, value.IsDefined() ? value.Mark() : node_.Mark()), path_, key,
                                 found, expected));
}

bool YamlMap::has(std::string_view key) const {
    return node_[std::string(key)].IsDefined();
}

std::optional<std::string> YamlMap::scalar(const std::string& key, const std::string& expected,
                                           const std::string& fallback, std::string_view help) {
    known_.push_back(key);
    if (!help.empty()) {
        described_->push_back({path_ + key, expected, fallback, std::string(help)});
    }
    const YAML::Node value = node_[key];
    if (!value.IsDefined()) {
        return std::nullopt;
    }
    if (!value.IsScalar()) {
        refuse(key, value.IsNull() ? "nothing" : value.IsSequence() ? "a list" : "a mapping", expected);
    }
    return value.Scalar();
}

float YamlMap::in_range(const std::string& key, const std::string& typed, const Range& range) const {
    const std::string expected = fmt::format("a number from {} to {}", range.low, range.high);
    float value = 0.0f;
    const auto [end, error] = std::from_chars(typed.data(), typed.data() + typed.size(), value);
    if (error != std::errc() || end != typed.data() + typed.size() || !std::isfinite(value) ||
        value < range.low || value > range.high) {
        const bool number_first = error == std::errc() && end != typed.data() && std::isfinite(value);
        refuse(key, shown(typed),
               expected + (number_first && end != typed.data() + typed.size()
                               ? "; write the number without its unit, which is in the key"
                               : ""));
    }
    return value * range.unit;
}

float YamlMap::number(const std::string& key, float fallback, const Range& range, std::string_view help) {
    const auto typed = scalar(key, fmt::format("a number from {} to {}", range.low, range.high),
                              fmt::format("{:.6g}", fallback / range.unit), help);
    return typed ? in_range(key, *typed, range) : fallback;
}

template <class Integer>
Integer YamlMap::integer(const std::string& key, Integer fallback, Integer low, Integer high,
                         std::string_view help) {
    const std::string expected = fmt::format("a whole number from {} to {}", low, high);
    const auto typed = scalar(key, expected, fmt::format("{}", fallback), help);
    if (!typed) {
        return fallback;
    }
    Integer value = 0;
    const auto [end, error] = std::from_chars(typed->data(), typed->data() + typed->size(), value);
    if (error != std::errc() || end != typed->data() + typed->size() || value < low || value > high) {
        refuse(key, shown(*typed), expected);
    }
    return value;
}

int YamlMap::whole(const std::string& key, int fallback, int low, int high, std::string_view help) {
    return integer(key, fallback, low, high, help);
}

std::uint64_t YamlMap::seed(const std::string& key, std::uint64_t fallback, std::string_view help) {
    return integer<std::uint64_t>(key, fallback, 0, std::numeric_limits<std::uint64_t>::max(), help);
}

bool YamlMap::flag(const std::string& key, bool fallback, std::string_view help) {
    const auto typed = scalar(key, "on or off", fallback ? "on" : "off", help);
    if (!typed) {
        return fallback;
    }
    if (*typed == "on" || *typed == "true") {
        return true;
    }
    if (*typed == "off" || *typed == "false") {
        return false;
    }
    refuse(key, shown(*typed), "on or off");
}

std::string YamlMap::text(const std::string& key, const std::string& fallback, std::string_view help) {
    const std::string expected = fmt::format("a text of at most {} letters", longest_text);
    std::string typed = scalar(key, expected, fallback, help).value_or(fallback);
    if (typed.size() > longest_text) {
        refuse(key, fmt::format("{} letters", typed.size()), expected);
    }
    if (escaped_lines(typed) != typed) {
        refuse(key, shown(typed), expected + ", without control characters");
    }
    return typed;
}

std::string YamlMap::name(const std::string& key, const std::string& fallback, std::string_view help) {
    const std::string expected = fmt::format("one line of 1 to {} letters", longest_name);
    const auto typed = scalar(key, expected, fallback, help);
    const std::string value = typed.value_or(fallback.substr(0, longest_name));
    if (typed && (value.empty() || value.size() > longest_name || escaped(value) != value)) {
        refuse(key, shown(value), expected);
    }
    return value;
}

std::size_t YamlMap::choice(const std::string& key, std::size_t fallback,
                            std::span<const std::string_view> names, std::string_view help) {
    const std::string expected = fmt::format("one of {}", fmt::join(names, ", "));
    const auto typed = scalar(key, expected, std::string(names[fallback]), help);
    if (!typed) {
        return fallback;
    }
    const auto found = std::find(names.begin(), names.end(), *typed);
    if (found == names.end()) {
        refuse(key, shown(*typed), expected);
    }
    return static_cast<std::size_t>(found - names.begin());
}

Vec3f YamlMap::vector(const std::string& key, const Range& range) {
    known_.push_back(key);
    const YAML::Node value = node_[key];
    Vec3f out = Vec3f::Zero();
    if (!value.IsDefined()) {
        return out;
    }
    const std::string expected = fmt::format(
        "a list [left, posterior, superior] of three numbers from {} to {}", range.low, range.high);
    if (!value.IsSequence() || value.size() != 3) {
        refuse(key, value.IsSequence() ? fmt::format("{} entries", value.size()) : "not a list", expected);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if (!value[k].IsScalar()) {
            refuse(key, "an entry that is not a number", expected);
        }
        out[static_cast<Eigen::Index>(k)] = in_range(key, value[k].Scalar(), range);
    }
    return out;
}

std::optional<YamlMap> YamlMap::map(const std::string& key) {
    known_.push_back(key);
    const YAML::Node value = node_[key];
    if (!value.IsDefined()) {
        return std::nullopt;
    }
    return YamlMap(value, file_, path_ + key + ".", described_);
}

std::vector<YamlMap> YamlMap::list(const std::string& key) {
    known_.push_back(key);
    const YAML::Node value = node_[key];
    std::vector<YamlMap> out;
    if (!value.IsDefined()) {
        return out;
    }
    if (!value.IsSequence()) {
        refuse(key, "not a list", "a list of '- key: value' entries");
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
        out.push_back(YamlMap(value[i], file_, fmt::format("{}{}[{}].", path_, key, i), described_));
    }
    return out;
}

void YamlMap::finish() const {
    for (const auto& entry : node_) {
        const std::string key = entry.first.Scalar();
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
            throw InputError(fmt::format("{}: unknown key '{}{}', expected one of: {}{}",
                                         place(file_, entry.first.Mark()), path_, shortened(key),
                                         fmt::join(known_, ", "), guess(key, known_)));
        }
    }
}

}  // namespace eti
