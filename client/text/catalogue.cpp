// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/text/catalogue.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>

// Message catalogues as msgfmt compiles them, embedded by the assembler.
#define ETI_EMBED_CATALOGUE(code)             \
    asm(".section .rodata\n"                  \
        ".balign 4\n"                         \
        ".global eti_catalogue_" #code        \
        "\n"                                  \
        "eti_catalogue_" #code                \
        ":\n"                                 \
        ".incbin \"" ETI_CATALOGUES "/" #code \
        ".mo\"\n"                             \
        ".byte 0\n"                           \
        ".previous\n");                       \
    extern "C" const char eti_catalogue_##code[]

ETI_EMBED_CATALOGUE(de);
ETI_EMBED_CATALOGUE(fr);
ETI_EMBED_CATALOGUE(es);
ETI_EMBED_CATALOGUE(vi);

namespace eti::text {
namespace {

constexpr std::array language_table{Language{"en", "English"}, Language{"de", "Deutsch"},
                                    Language{"fr", "Français"}, Language{"es", "Español"},
                                    Language{"vi", "Tiếng Việt"}};

/// A compiled catalogue of GNU gettext: header, then two tables of length and offset, the originals sorted
/// (gettext's manual, "The Format of GNU MO Files"). Read here rather than by libintl, whose language is that
/// of the whole process: it would also translate the system's messages in logs, and needs a generated locale.
class Catalogue {
  public:
    explicit Catalogue(const char* bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint32_t size() const { return word(8); }
    [[nodiscard]] std::string_view original(std::uint32_t i) const { return string(word(12), i); }
    [[nodiscard]] std::string_view translation(std::uint32_t i) const { return string(word(16), i); }

    [[nodiscard]] std::optional<std::string_view> find(std::string_view english) const {
        std::uint32_t low = 0, high = size();
        while (low < high) {
            const std::uint32_t middle = low + (high - low) / 2;
            const std::string_view here = original(middle);
            if (here == english) {
                return translation(middle);
            }
            here < english ? low = middle + 1 : high = middle;
        }
        return std::nullopt;
    }

  private:
    [[nodiscard]] std::uint32_t word(std::size_t offset) const {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes_ + offset, sizeof value);
        return value;
    }
    [[nodiscard]] std::string_view string(std::uint32_t table, std::uint32_t i) const {
        const std::size_t entry = table + 8ull * i;
        return {bytes_ + word(entry + 4), word(entry)};
    }

    const char* bytes_;
};

constexpr std::array<const char*, language_table.size()> catalogues{
    nullptr, eti_catalogue_de, eti_catalogue_fr, eti_catalogue_es, eti_catalogue_vi};

std::atomic<std::size_t> selected{0};

std::optional<std::size_t> index_of(std::string_view code) {
    const auto found = std::ranges::find(language_table, code, &Language::code);
    return found == language_table.end()
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(found - language_table.begin()));
}

std::optional<Catalogue> current() {
    const char* const bytes = catalogues[selected.load(std::memory_order_relaxed)];
    return bytes == nullptr ? std::nullopt : std::optional(Catalogue(bytes));
}

std::string_view variable(const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
}

}  // namespace

std::span<const Language> languages() {
    return language_table;
}

std::string_view language_of_environment() {
    std::string_view locale;
    for (const char* const name : {"LC_ALL", "LC_MESSAGES", "LANG"}) {
        locale = locale.empty() ? variable(name) : locale;
    }
    // Like gettext: in the C locale LANGUAGE is ignored.
    std::string wanted(locale);
    if (!locale.empty() && locale != "C" && locale != "POSIX" && !variable("LANGUAGE").empty()) {
        wanted = std::string(variable("LANGUAGE")) + ":" + wanted;
    }
    for (std::size_t begin = 0; begin < wanted.size();) {
        const std::size_t end = std::min(wanted.find(':', begin), wanted.size());
        const std::string_view one = std::string_view(wanted).substr(begin, end - begin);
        if (const auto index = index_of(one.substr(0, one.find_first_of("_.@")))) {
            return language_table[*index].code;
        }
        begin = end + 1;
    }
    return language_table.front().code;
}

void set_language(std::string_view code) {
    selected = index_of(code).value_or(0);
}

std::string_view language() {
    return language_table[selected.load(std::memory_order_relaxed)].code;
}

std::string_view translate(std::string_view english) {
    const auto catalogue = current();
    // The empty text's entry is the catalogue's header.
    const auto found = catalogue && !english.empty() ? catalogue->find(english) : std::nullopt;
    return found && !found->empty() ? *found : english;
}

std::string translate_arguments(std::string_view english, fmt::format_args arguments) {
    try {
        const std::string_view text = translate(english);
        return fmt::vformat(fmt::string_view(text.data(), text.size()), arguments);
    } catch (const fmt::format_error&) {  // a broken translation must not end a session
        return fmt::vformat(fmt::string_view(english.data(), english.size()), arguments);
    }
}

std::vector<std::pair<std::string_view, std::string_view>> entries() {
    std::vector<std::pair<std::string_view, std::string_view>> out;
    if (const auto catalogue = current()) {
        for (std::uint32_t i = 0; i < catalogue->size(); ++i) {
            if (!catalogue->original(i).empty()) {
                out.emplace_back(catalogue->original(i), catalogue->translation(i));
            }
        }
    }
    return out;
}

}  // namespace eti::text
