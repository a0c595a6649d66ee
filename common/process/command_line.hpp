// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Command-line parser for all programs. CLI11 is used inside command_line.cpp alone: its headers contain all
// of its code, which would cost each program's main about ten seconds of compile time.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace eti {

/// Range of a number on the command line, both ends included.
template <class Number>
struct NumberLimits {
    Number low;
    Number high = std::numeric_limits<Number>::max();
    std::string unit = {};  ///< the unit as typed: "mm", "s"; empty: none
};

template <class Value>
struct NumberOf {
    using type = Value;
};
template <class Value>
struct NumberOf<std::optional<Value>> {
    using type = Value;
};

/// Exit status after a usage error.
inline constexpr int exit_usage_error = 2;

/// Thrown by a callback for well-formed options that contradict each other; parse() prints its text.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// An option, flag or positional argument of a command line. A handle: copies refer to the same option, and
/// are invalid once the command line is destroyed. Setters return the handle for chaining.
class Option {
  public:
    /// Rejects a command line without it.
    Option required(bool value = true);
    /// Shows the variable's current value in `--help` as the default.
    Option capture_default_str();
    /// Lists it in `--help` under this heading.
    Option group(const std::string& heading);
    /// Names its value in `--help`, instead of TEXT.
    Option type_name(const std::string& name);

    /// Takes from `least` to `most` values.
    Option expected(int least, int most);
    /// May be repeated; all values are kept, and `--help` shows one.
    Option repeatable();
    /// False: takes one value per occurrence and leaves the next word to others.
    Option allow_extra_args(bool value);

    /// Rejects it without `other`.
    Option needs(const Option& other);
    /// Rejects it together with `other`.
    Option excludes(const Option& other);
    /// The same for several options by name. Throws std::runtime_error for one that is not declared yet.
    Option excludes(std::initializer_list<const char*> others);

    /// Rejects a value for which `validation_error` returns a reason, which is printed; an empty text accepts
    /// the value. `description` is shown after the value's type in `--help`.
    Option check(std::function<std::string(const std::string&)> validation_error,
                 const std::string& description = {});
    /// Rejects any other word.
    Option one_of(const std::vector<std::string>& words);
    /// Rejects a path that is not an existing file.
    Option existing_file();
    /// Rejects a path that is not an existing folder.
    Option existing_folder();

    /// Whether the command line lacks it.
    [[nodiscard]] bool empty() const;

  private:
    friend class CommandLine;
    explicit Option(CLI::Option* option) : option_(option) {}

    CLI::Option* option_;
};

/// The command line of a program, or of one of its subcommands. A handle: copies refer to the same command
/// line, which lives as long as one of them. Variables bound to options must outlive parse(). A declaration
/// that contradicts an earlier one, such as a duplicate name, throws std::runtime_error.
class CommandLine {
  public:
    /// Declares `--help` and `--version`. Without a name, `--help` shows the name of the executable as it was
    /// started.
    explicit CommandLine(const std::string& description, const std::string& name = {});

    /// Adds an option "--name", or a positional argument "NAME"; its value or values go into `value`.
    Option add_option(const std::string& name, std::string& value, const std::string& description = {});
    Option add_option(const std::string& name, std::filesystem::path& value, const std::string& description);
    Option add_option(const std::string& name, std::vector<std::string>& values,
                      const std::string& description);
    Option add_option(const std::string& name, std::vector<std::filesystem::path>& values,
                      const std::string& description);
    /// One list per occurrence.
    Option add_option(const std::string& name, std::vector<std::vector<std::string>>& lists,
                      const std::string& description);

    /// Adds an option for a number or a std::optional of one; all programs declare numbers this way. Accepts
    /// only decimal, finite numbers within the limits: no "nan", no "0x1f", no "5mm", no -1 for 2^64 - 1. An
    /// error states what was found and what was expected. `--help` shows the range;
    /// tests/system/test_numbers.py reads it there and tests it. For int, float, double and unsigned integers
    /// of 16, 32 and 64 bits.
    template <class Value>
    Option add_number(const std::string& name, Value& value, const std::string& description,
                      const NumberLimits<typename NumberOf<Value>::type>& limits);

    /// Adds a flag that sets `value`; "!--no-name" clears it.
    Option add_flag(const std::string& name, bool& value, const std::string& description);

    /// Adds a subcommand, which inherits its parent's fallthrough().
    [[nodiscard]] CommandLine add_subcommand(const std::string& name, const std::string& description);

    /// Rejects a command line without exactly `count` subcommands.
    void require_subcommand(int count);
    /// Passes options that a subcommand does not know to its parent.
    void fallthrough(bool value = true);
    /// Keeps undeclared words in remaining() instead of rejecting them.
    void allow_extras();
    /// Appends this text to `--help`.
    void footer(const std::string& text);
    /// Calls `done` after successful parsing; a subcommand's only if that subcommand was given. May throw
    /// UsageError.
    void callback(std::function<void()> done);

    /// Parses. Returns the exit status if the program is to end: 0 after printing --help or --version, 2
    /// after printing an error. For a program's command line only.
    [[nodiscard]] std::optional<int> parse(int argc, const char* const* argv);

    [[nodiscard]] std::string name() const;
    /// An option by its name; throws std::runtime_error if there is none.
    [[nodiscard]] Option option(const std::string& name) const;
    /// Whether a subcommand was given.
    [[nodiscard]] bool parsed() const;
    /// Words kept by allow_extras().
    [[nodiscard]] std::vector<std::string> remaining() const;

  private:
    explicit CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}

    std::shared_ptr<CLI::App> app_;
};

}  // namespace eti
