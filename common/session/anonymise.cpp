// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/anonymise.hpp"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "common/hdf5/copy.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"

namespace eti::session {

namespace {

/// Texts of `meta/more` needed to simulate a session again; all others are removed.
constexpr std::array kept_more{processor_text, libraries_text, physics_text, patient_hash_text};

/// Paths of text data sets that contain names of people.
constexpr std::array name_columns{"inputs/commands/sender", "annotations/sender", "ratings/rater"};

/// The text before one of these is the author of an event.
constexpr std::array after_author{": ", " points at ", " draws on ", " wipes all marks away"};

std::string author_of(const EventRecord& event) {
    if (event.kind != note_event && event.kind != annotation_event) {
        return {};
    }
    std::size_t end = std::string::npos;
    for (const char* after : after_author) {
        end = std::min(end, event.text.find(after));
    }
    return end == std::string::npos ? std::string() : event.text.substr(0, end);
}

/// Names and their replacements, in order of appearance.
class People {
  public:
    void add(const std::string& name) {
        if (!name.empty() && !words_.contains(name)) {
            words_.emplace(name, fmt::format("person {}", words_.size() + 1));
        }
    }
    [[nodiscard]] std::string of(const std::string& name) const {
        const auto found = words_.find(name);
        return found == words_.end() ? std::string() : found->second;
    }
    [[nodiscard]] std::size_t count() const { return words_.size(); }
    /// `text` without these names. Names shorter than three letters could be parts of words.
    [[nodiscard]] std::string without(std::string text) const {
        std::vector<std::string> names;
        for (const auto& [name, word] : words_) {
            if (name.size() >= 3) {
                names.push_back(name);
            }
        }
        std::ranges::sort(names, std::ranges::greater{}, &std::string::size);
        for (const std::string& name : names) {
            const std::string& word = words_.at(name);
            for (std::size_t at = text.find(name); at != std::string::npos;
                 at = text.find(name, at + word.size())) {
                text.replace(at, name.size(), word);
            }
        }
        return text;
    }

  private:
    std::map<std::string, std::string> words_;
};

}  // namespace

std::vector<std::string> anonymise(const std::filesystem::path& from, const std::filesystem::path& to,
                                   const std::string& participant) {
    const SessionReader reader(from);
    if (reader.is_being_recorded()) {
        throw hdf5::Error(fmt::format(
            "{}: a running program is recording to this file; expected a finished one: end the session first",
            from.string()));
    }
    const SessionInfo& info = reader.info();
    People people;
    for (const CommandRecord& command : reader.commands()) {
        people.add(command.sender);
    }
    for (const AnnotationRecord& annotation : reader.annotations()) {
        people.add(annotation.sender);
    }
    const std::vector<EventRecord> events = reader.events();
    for (const EventRecord& event : events) {
        people.add(author_of(event));
    }
    for (const Rating& rating : read_ratings(reader.root())) {
        people.add(rating.rater);
    }
    People own = people;  // occurrences of the participant in a text
    if (const auto found = info.more.find(participant_text); found != info.more.end()) {
        own.add(found->second);
    }

    hdf5::CopyRules rules;
    rules.keep = [&](std::string_view path) {
        constexpr std::string_view more = "meta/more/";
        if (path.starts_with(more)) {
            return std::ranges::find(kept_more, path.substr(more.size())) != kept_more.end();
        }
        return path != "tail";
    };
    rules.rewrite = [&](std::string_view path, std::size_t row,
                        std::string_view text) -> std::optional<std::string> {
        if (path == "meta/session") {
            return "anonymous";
        }
        if (path == "meta/start_time" || path == "ratings/given" || path == "answers/given") {
            return "";
        }
        if (std::ranges::find(name_columns, path) != name_columns.end()) {
            return people.of(std::string(text));
        }
        if (path == "events/text" && row < events.size()) {
            // A two-letter name is replaced only where it is the author.
            const std::string author = author_of(events[row]);
            std::string out = own.without(std::string(text.substr(author.size())));
            return author.empty() ? out : people.of(author) + out;
        }
        if (path == "annotations/text" || path == "answers/answer") {
            return own.without(std::string(text));
        }
        return std::nullopt;
    };
    AtomicFileWriter unfinished(to);
    try {
        hdf5::File file = hdf5::File::create(unfinished.path());
        hdf5::copy_members(reader.root(), file.root(), rules);
        if (!participant.empty()) {
            file.root().open("meta").open("more").set_text(participant_text, participant);
        }
        file.close();
    } catch (const hdf5::Error& error) {
        // The library names the file that is read, not the one that cannot be written.
        if (const std::string why = full_disk_reason(error.what()); !why.empty()) {
            throw hdf5::Error(fmt::format(
                "{}: cannot be written: {}; free some space or choose another with --out", to.string(), why));
        }
        throw;
    }
    (void)SessionReader(unfinished.path()).scene();
    unfinished.finish();
    std::vector<std::string> gone{"the session's name, its start and the file's own times"};
    for (const auto& [key, value] : info.more) {
        if (std::ranges::find(kept_more, key) == kept_more.end()) {
            gone.push_back(key == participant_text && !participant.empty()
                               ? fmt::format("the participant, now {}", participant)
                               : key);
        }
    }
    if (people.count() > 0) {
        gone.push_back(fmt::format("names of {} people", people.count()));
    }
    return gone;
}

}  // namespace eti::session
