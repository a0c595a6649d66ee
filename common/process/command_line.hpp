// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

namespace eti {

/// What a number of the command line may be, both ends included.
template <class Number>
struct NumberLimits {
    Number low;
    Number high = std::numeric_limits<Number>::max();
    std::string unit = {};  ///< the one that is typed: "mm", "s"; empty: none
};

/// "0 to 30 mm"; "0 or more" of a real number without an end.
template <class Number>
[[nodiscard]] std::string range_text(const NumberLimits<Number>& limits);

/// Why `text` is no such number: what was found and what was expected. Empty where it is one; then `text` is
/// written anew, so that whoever reads it next reads the same number. Decimal digits alone are a number, and
/// only finite ones are: no "nan", no "0x1f", no "5mm".
template <class Number>
[[nodiscard]] std::string why_no_number(std::string& text, const NumberLimits<Number>& limits);

template <class Value>
struct NumberOf {
    using type = Value;
};
template <class Value>
struct NumberOf<std::optional<Value>> {
    using type = Value;
};

/// An option for a number, a plain one or std::optional of one. All programs declare all of theirs by this:
/// CLI::Range takes NaN for a number in any range, and -1 for 2^64 - 1 where counts are unsigned.
/// `--help` shows the range; tests/system/test_numbers.py reads it there and tries it from outside.
template <class Value>
CLI::Option* add_number(CLI::App& app, const std::string& name, Value& value, const std::string& description,
                        const NumberLimits<typename NumberOf<Value>::type>& limits) {
    // A transformation, not a check: the text is written anew.
    return app.add_option(name, value, description)
        ->transform(CLI::Validator([limits](std::string& text) { return why_no_number(text, limits); },
                                   std::string()))
        ->type_name((std::is_integral_v<typename NumberOf<Value>::type> ? "COUNT [" : "NUMBER [") +
                    range_text(limits) + "]");
}

/// Exit status of a program that was called wrongly.
inline constexpr int status_of_misuse = 2;

/// Parses; the exit status where the program is done already: 0 after --help and --version, which are
/// printed, 2 after a mistake, which is said.
[[nodiscard]] std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

}  // namespace eti
