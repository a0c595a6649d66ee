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

// Command lines as the programs need them. CLI11 parses them, inside command_line.cpp alone: its headers hold
// all of its code, which would cost each program's main about ten seconds of compile time.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace eti {

/// What a number of the command line may be, both ends included.
template <class Number>
struct NumberLimits {
    Number low;
    Number high = std::numeric_limits<Number>::max();
    std::string unit = {};  ///< the one that is typed: "mm", "s"; empty: none
};

template <class Value>
struct NumberOf {
    using type = Value;
};
template <class Value>
struct NumberOf<std::optional<Value>> {
    using type = Value;
};

/// Exit status of a program that was called wrongly.
inline constexpr int status_of_misuse = 2;

/// Thrown by a callback where options that are each well-formed do not go together; parse() prints its text.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// An option, flag or positional argument of a command line. A handle: copies refer to the same option, and
/// none may be used once the command line is gone. Setters return the handle, to be chained.
class Option {
  public:
    /// Refuses a command line that does not give it.
    Option required(bool value = true);
    /// Shows the variable's present value in `--help` as the default.
    Option capture_default_str();
    /// Lists it in `--help` under this heading.
    Option group(const std::string& heading);
    /// Names its value in `--help`, instead of TEXT.
    Option type_name(const std::string& name);

    /// Takes from `least` to `most` values.
    Option expected(int least, int most);
    /// May be given several times; all values are kept, and `--help` shows one.
    Option repeatable();
    /// False: takes one value each time that it is given, and leaves the next word to others.
    Option allow_extra_args(bool value);

    /// Refuses it without `other`.
    Option needs(const Option& other);
    /// Refuses it beside `other`.
    Option excludes(const Option& other);
    /// The same for several by name. Throws std::runtime_error where one is not declared yet.
    Option excludes(std::initializer_list<const char*> others);

    /// Refuses a value where `why_refused` returns a reason, which is printed; an empty one takes the value.
    /// `description` stands behind the value's type in `--help`.
    Option check(std::function<std::string(const std::string&)> why_refused,
                 const std::string& description = {});
    /// Refuses what is none of these words.
    Option one_of(const std::vector<std::string>& words);
    /// Refuses a path that leads to no file.
    Option existing_file();
    /// Refuses a path that leads to no folder.
    Option existing_folder();

    /// Returns whether the command line did not give it.
    [[nodiscard]] bool empty() const;

  private:
    friend class CommandLine;
    explicit Option(CLI::Option* option) : option_(option) {}

    CLI::Option* option_;
};

/// The command line of a program, or of one of its subcommands. A handle: copies refer to the same command
/// line, which lives as long as one of them. Variables that options are bound to must outlive parse(). A
/// declaration that contradicts an earlier one, such as a name that is taken, throws std::runtime_error.
class CommandLine {
  public:
    /// Without a name, `--help` shows the one that the program was started by.
    explicit CommandLine(const std::string& description, const std::string& name = {});

    /// Adds an option "--name", or a positional argument "NAME", whose value or values `value` receives.
    Option add_option(const std::string& name, std::string& value, const std::string& description = {});
    Option add_option(const std::string& name, std::filesystem::path& value, const std::string& description);
    Option add_option(const std::string& name, std::vector<std::string>& values,
                      const std::string& description);
    Option add_option(const std::string& name, std::vector<std::filesystem::path>& values,
                      const std::string& description);
    /// One list each time that it is given.
    Option add_option(const std::string& name, std::vector<std::vector<std::string>>& lists,
                      const std::string& description);

    /// Adds an option for a number, a plain one or std::optional of one; all programs declare theirs by this.
    /// Decimal digits alone are a number, and only finite ones within the limits are taken: no "nan", no
    /// "0x1f", no "5mm", no -1 for 2^64 - 1. A refusal tells what was found and what was expected. `--help`
    /// shows the range; tests/system/test_numbers.py reads it there and tries it from outside. Of int, float,
    /// double and unsigned integers of 16, 32 and 64 bits.
    template <class Value>
    Option add_number(const std::string& name, Value& value, const std::string& description,
                      const NumberLimits<typename NumberOf<Value>::type>& limits);

    /// Adds a flag that sets `value`; "!--no-name" clears it.
    Option add_flag(const std::string& name, bool& value, const std::string& description);

    /// Adds a flag that prints the version and ends the program.
    void set_version_flag(const std::string& name, const std::string& version);

    /// Adds a subcommand. It begins with its parent's fallthrough().
    [[nodiscard]] CommandLine add_subcommand(const std::string& name, const std::string& description);

    /// Refuses a command line without exactly `count` subcommands.
    void require_subcommand(int count);
    /// Leaves options that a subcommand does not know to its parent.
    void fallthrough(bool value = true);
    /// Keeps words that nothing is declared for, in remaining(), instead of refusing them.
    void allow_extras();
    /// Ends `--help` with this text.
    void footer(const std::string& text);
    /// Has `done` called once all is parsed without a mistake; a subcommand's only where that was given. May
    /// throw UsageError.
    void callback(std::function<void()> done);

    /// Parses. Returns the exit status where the program is done already: 0 after --help and --version, which
    /// are printed, 2 after a mistake, which is said. Of a program's command line only.
    [[nodiscard]] std::optional<int> parse(int argc, const char* const* argv);

    [[nodiscard]] std::string name() const;
    /// Returns an option by its name; throws std::runtime_error where there is none.
    [[nodiscard]] Option option(const std::string& name) const;
    /// Returns whether a subcommand was given.
    [[nodiscard]] bool parsed() const;
    /// Returns what allow_extras() has kept.
    [[nodiscard]] std::vector<std::string> remaining() const;

  private:
    explicit CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}

    std::shared_ptr<CLI::App> app_;
};

}  // namespace eti
