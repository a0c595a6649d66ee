// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/command_line.hpp"

#include <fmt/format.h>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <sstream>

#include "common/process/escaped.hpp"

namespace eti {

template <class Number>
std::string range_text(const NumberLimits<Number>& limits) {
    const std::string unit = limits.unit.empty() ? "" : " " + limits.unit;
    return std::is_integral_v<Number> || limits.high < std::numeric_limits<Number>::max()
               ? fmt::format("{} to {}{}", limits.low, limits.high, unit)
               : fmt::format("{} or more{}", limits.low, unit);
}

template <class Number>
std::string why_no_number(std::string& text, const NumberLimits<Number>& limits) {
    // A sign in front is usual, and unknown to from_chars.
    const char* const begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
    const char* const end = text.data() + text.size();
    constexpr bool whole = std::is_integral_v<Number>;
    const auto refused = [&](const std::string& finding) {
        return fmt::format("'{}' {}; expected a {}, {}", escaped(text, longest_shown), finding,
                           whole ? "whole number" : "number", range_text(limits));
    };
    // Wide enough to tell what is out of the type's own range.
    using Wide = std::conditional_t<!whole, double, Number>;
    Wide value{};
    const auto [rest, error] = std::from_chars(begin, end, value);
    const bool number_first = rest != begin && error != std::errc::invalid_argument;
    const bool negative = whole && begin != end && *begin == '-' && std::is_unsigned_v<Number>;
    if (negative) {
        std::int64_t below = 0;
        const auto [after, none] = std::from_chars(begin, end, below);
        return refused(after == end && none != std::errc::invalid_argument ? "is too small"
                                                                           : "is no whole number");
    }
    if constexpr (!whole) {
        if (number_first && error == std::errc() && !std::isfinite(value)) {
            return refused("is no number");
        }
    }
    if (!number_first || rest != end) {
        const bool unit_follows = number_first && (std::isalpha(static_cast<unsigned char>(*rest)) != 0 ||
                                                   *rest == ' ' || *rest == '%');
        return refused(unit_follows ? "is more than a number, which stands alone"
                       : whole      ? "is no whole number"
                                    : "is no number");
    }
    if (error == std::errc::result_out_of_range) {
        return refused("is out of range");
    }
    // In the type's own precision: 0.7 is within 0.7f.
    if (static_cast<Number>(value) < limits.low) {
        return refused("is too small");
    }
    if (static_cast<Number>(value) > limits.high) {
        return refused("is too large");
    }
    text = fmt::format("{}", value);
    return {};
}

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream said;
        const int status = app.exit(error, std::cout, said);
        std::cerr << escaped_lines(said.str()) << std::flush;
        return status == 0 ? 0 : status_of_misuse;
    }
    return std::nullopt;
}

#define ETI_NUMBER(Number)                                        \
    template std::string range_text(const NumberLimits<Number>&); \
    template std::string why_no_number(std::string&, const NumberLimits<Number>&);
ETI_NUMBER(int)
ETI_NUMBER(float)
ETI_NUMBER(double)
ETI_NUMBER(std::uint16_t)
ETI_NUMBER(std::uint32_t)
ETI_NUMBER(std::uint64_t)
#undef ETI_NUMBER

}  // namespace eti
