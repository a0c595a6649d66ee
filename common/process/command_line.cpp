// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/command_line.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <sstream>
#include <type_traits>

#include "common/process/escaped.hpp"

namespace eti {

namespace {

/// "0 to 30 mm"; "0 or more" of a real number without an end.
template <class Number>
std::string range_text(const NumberLimits<Number>& limits) {
    const std::string unit = limits.unit.empty() ? "" : " " + limits.unit;
    return std::is_integral_v<Number> || limits.high < std::numeric_limits<Number>::max()
               ? fmt::format("{} to {}{}", limits.low, limits.high, unit)
               : fmt::format("{} or more{}", limits.low, unit);
}

/// Why `text` is not such a number: what was found and what was expected. Empty if it is one. Then `text` is
/// normalised, so that CLI11, which parses it next, gets the same number: its own conversion takes "010" for
/// eight, its Range accepts NaN, and unsigned counts accept -1 as 2^64 - 1.
template <class Number>
std::string number_error(std::string& text, const NumberLimits<Number>& limits) {
    // A leading sign is common, but from_chars does not accept it.
    const char* const begin = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
    const char* const end = text.data() + text.size();
    constexpr bool whole = std::is_integral_v<Number>;
    const auto refused = [&](const std::string& finding) {
        return fmt::format("'{}' {}; expected a {}, {}", escaped(text, max_shown_bytes), finding,
                           whole ? "whole number" : "number", range_text(limits));
    };
    // Wide enough to recognise values outside the type's own range.
    using Wide = std::conditional_t<!whole, double, Number>;
    Wide value{};
    const auto [rest, error] = std::from_chars(begin, end, value);
    const bool number_first = rest != begin && error != std::errc::invalid_argument;
    const bool negative = whole && begin != end && *begin == '-' && std::is_unsigned_v<Number>;
    if (negative) {
        std::int64_t below = 0;
        const auto [after, none] = std::from_chars(begin, end, below);
        return refused(after == end && none != std::errc::invalid_argument ? "is too small"
                                                                           : "is not a whole number");
    }
    if constexpr (!whole) {
        if (number_first && error == std::errc() && !std::isfinite(value)) {
            return refused("is not a number");
        }
    }
    if (!number_first || rest != end) {
        const bool unit_follows = number_first && (std::isalpha(static_cast<unsigned char>(*rest)) != 0 ||
                                                   *rest == ' ' || *rest == '%');
        return refused(unit_follows ? "has characters after the number"
                       : whole      ? "is not a whole number"
                                    : "is not a number");
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

}  // namespace

Option Option::required(bool value) {
    return Option(option_->required(value));
}

Option Option::capture_default_str() {
    return Option(option_->capture_default_str());
}

Option Option::group(const std::string& heading) {
    return Option(option_->group(heading));
}

Option Option::type_name(const std::string& name) {
    return Option(option_->type_name(name));
}

Option Option::expected(int least, int most) {
    return Option(option_->expected(least, most));
}

Option Option::repeatable() {
    return Option(option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
}

Option Option::allow_extra_args(bool value) {
    return Option(option_->allow_extra_args(value));
}

Option Option::needs(const Option& other) {
    return Option(option_->needs(other.option_));
}

Option Option::excludes(const Option& other) {
    return Option(option_->excludes(other.option_));
}

Option Option::excludes(std::initializer_list<const char*> others) {
    for (const char* const other : others) {
        option_->excludes(std::string(other));
    }
    return *this;
}

Option Option::check(std::function<std::string(const std::string&)> validation_error,
                     const std::string& description) {
    return Option(option_->check(std::move(validation_error), description));
}

Option Option::one_of(const std::vector<std::string>& words) {
    return Option(option_->check(CLI::IsMember(words)));
}

Option Option::existing_file() {
    return Option(option_->check(CLI::ExistingFile));
}

Option Option::existing_folder() {
    return Option(option_->check(CLI::ExistingDirectory));
}

bool Option::empty() const {
    return option_->empty();
}

CommandLine::CommandLine(const std::string& description, const std::string& name)
    : app_(std::make_shared<CLI::App>(description, name)) {
    app_->set_version_flag("--version", ETI_VERSION);
}

Option CommandLine::add_option(const std::string& name, std::string& value, const std::string& description) {
    return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::filesystem::path& value,
                               const std::string& description) {
    return Option(app_->add_option(name, value, description));
}

Option CommandLine::add_option(const std::string& name, std::vector<std::string>& values,
                               const std::string& description) {
    return Option(app_->add_option(name, values, description));
}

Option CommandLine::add_option(const std::string& name, std::vector<std::filesystem::path>& values,
                               const std::string& description) {
    return Option(app_->add_option(name, values, description));
}

Option CommandLine::add_option(const std::string& name, std::vector<std::vector<std::string>>& lists,
                               const std::string& description) {
    return Option(app_->add_option(name, lists, description));
}

template <class Value>
Option CommandLine::add_number(const std::string& name, Value& value, const std::string& description,
                               const NumberLimits<typename NumberOf<Value>::type>& limits) {
    // A transformation, not a check: it normalises the text.
    return Option(
        app_->add_option(name, value, description)
            ->transform(CLI::Validator([limits](std::string& text) { return number_error(text, limits); },
                                       std::string()))
            ->type_name((std::is_integral_v<typename NumberOf<Value>::type> ? "COUNT [" : "NUMBER [") +
                        range_text(limits) + "]"));
}

Option CommandLine::add_flag(const std::string& name, bool& value, const std::string& description) {
    return Option(app_->add_flag(name, value, description));
}

CommandLine CommandLine::add_subcommand(const std::string& name, const std::string& description) {
    // Shares ownership of the whole program's command line.
    return CommandLine(std::shared_ptr<CLI::App>(app_, app_->add_subcommand(name, description)));
}

void CommandLine::require_subcommand(int count) {
    app_->require_subcommand(count);
}

void CommandLine::fallthrough(bool value) {
    app_->fallthrough(value);
}

void CommandLine::allow_extras() {
    app_->allow_extras();
}

void CommandLine::footer(const std::string& text) {
    app_->footer(text);
}

void CommandLine::callback(std::function<void()> done) {
    app_->callback([done = std::move(done)] {
        try {
            done();
        } catch (const UsageError& error) {
            throw CLI::ValidationError(error.what());
        }
    });
}

std::optional<int> CommandLine::parse(int argc, const char* const* argv) {
    try {
        app_->parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream said;
        const int status = app_->exit(error, std::cout, said);
        std::cerr << escaped_lines(said.str()) << std::flush;
        return status == 0 ? 0 : exit_usage_error;
    }
    return std::nullopt;
}

std::string CommandLine::name() const {
    return app_->get_name();
}

Option CommandLine::option(const std::string& name) const {
    return Option(app_->get_option(name));
}

bool CommandLine::parsed() const {
    return app_->parsed();
}

std::vector<std::string> CommandLine::remaining() const {
    return app_->remaining();
}

#define ETI_NUMBER(Number)                                                                                  \
    template Option CommandLine::add_number(const std::string&, Number&, const std::string&,                \
                                            const NumberLimits<Number>&);                                   \
    template Option CommandLine::add_number(const std::string&, std::optional<Number>&, const std::string&, \
                                            const NumberLimits<Number>&);
ETI_NUMBER(int)
ETI_NUMBER(float)
ETI_NUMBER(double)
ETI_NUMBER(std::uint16_t)
ETI_NUMBER(std::uint32_t)
ETI_NUMBER(std::uint64_t)
#undef ETI_NUMBER

}  // namespace eti
