// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace eti::text {

/// A language in which all texts for users exist.
struct Language {
    std::string_view code;  ///< ISO 639-1
    std::string_view name;  ///< in the language itself
};

/// English first, in which the sources are written.
[[nodiscard]] std::span<const Language> languages();

/// The language that the environment asks for (LANGUAGE, LC_ALL, LC_MESSAGES, LANG, as gettext reads them);
/// "en" if none of its languages is here.
[[nodiscard]] std::string_view language_of_environment();

/// Selects the language of all later translations; a code of languages(). Call it before the first window
/// is drawn: texts that were translated before keep their language.
void set_language(std::string_view code);
[[nodiscard]] std::string_view language();

/// The text in the selected language; the English text itself where the catalogue has none. The result
/// lives as long as the program, or as `english` if it is that.
[[nodiscard]] std::string_view translate(std::string_view english);

/// Marks a text of a table for the catalogues; translate() it where it is shown.
[[nodiscard]] constexpr std::string_view translatable(std::string_view english) {
    return english;
}

[[nodiscard]] std::string translate_arguments(std::string_view english, fmt::format_args arguments);

/// Formats with the translated format string, whose fields may stand in another order.
template <class... Arguments>
[[nodiscard]] std::string translate_format(fmt::format_string<Arguments...> english,
                                           const Arguments&... arguments) {
    const fmt::string_view text = english;
    return translate_arguments({text.data(), text.size()}, fmt::make_format_args(arguments...));
}

/// Every English text of the selected language's catalogue with its translation; empty for English.
[[nodiscard]] std::vector<std::pair<std::string_view, std::string_view>> entries();

}  // namespace eti::text
