// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/command_line.hpp"

#include <gtest/gtest.h>
#include <iostream>
#include <sstream>

namespace eti {
namespace {

/// Captures a stream's output during its lifetime.
class Captured {
  public:
    explicit Captured(std::ostream& stream) : stream_(stream), usual_(stream.rdbuf(text_.rdbuf())) {}
    ~Captured() { stream_.rdbuf(usual_); }
    Captured(const Captured&) = delete;
    Captured& operator=(const Captured&) = delete;
    [[nodiscard]] std::string text() const { return text_.str(); }

  private:
    std::ostringstream text_;
    std::ostream& stream_;
    std::streambuf* usual_;
};

std::optional<int> parse(CommandLine& app, const std::vector<std::string>& arguments) {
    std::vector<const char*> words{"program"};
    for (const std::string& argument : arguments) {
        words.push_back(argument.c_str());
    }
    return app.parse(static_cast<int>(words.size()), words.data());
}

/// The first line that a program prints for these arguments; empty if it accepts them.
std::string refusal(CommandLine& app, const std::vector<std::string>& arguments) {
    const Captured said(std::cerr);
    const std::optional<int> status = parse(app, arguments);
    EXPECT_EQ(status, said.text().empty() ? std::nullopt : std::optional(exit_usage_error));
    return said.text().substr(0, said.text().find('\n'));
}

std::string help(CommandLine& app) {
    const Captured said(std::cout);
    EXPECT_EQ(parse(app, {"--help"}), 0);
    return said.text();
}

/// The output of a program with one number for these arguments.
template <class Value>
std::string said_to(const std::vector<std::string>& arguments, Value& value,
                    const NumberLimits<typename NumberOf<Value>::type>& limits) {
    CommandLine app("A program.", "program");
    app.add_number("--value", value, "A value", limits);
    return refusal(app, arguments);
}

TEST(CommandLine, NumberRangeIsInclusive) {
    double length = -1.0;
    for (const auto& [typed, read] : std::vector<std::pair<std::string, double>>{
             {"0", 0.0}, {"30", 30.0}, {"+0.25", 0.25}, {"1e1", 10.0}, {"007", 7.0}, {".5", 0.5}}) {
        EXPECT_EQ(said_to({"--value", typed}, length, {0.0, 30.0, "mm"}), "") << typed;
        EXPECT_EQ(length, read) << typed;
    }
    // A limit that binary numbers only approximate is still within the range.
    float share = 0.0f;
    EXPECT_EQ(said_to({"--value", "0.1"}, share, {0.1f, 0.7f}), "");
    EXPECT_EQ(said_to({"--value", "0.7"}, share, {0.1f, 0.7f}), "");
    EXPECT_EQ(share, 0.7f);
}

TEST(CommandLine, IntegersAreDecimalOverTheirFullRange) {
    std::uint64_t seed = 1;
    EXPECT_EQ(said_to({"--value", "18446744073709551615"}, seed, {0}), "");
    EXPECT_EQ(seed, 18446744073709551615u);
    // The library would parse octal digits.
    EXPECT_EQ(said_to({"--value", "010"}, seed, {0}), "");
    EXPECT_EQ(seed, 10u);
    std::optional<int> count;
    EXPECT_EQ(said_to({}, count, {0, 9}), "");
    EXPECT_EQ(count, std::nullopt);
    EXPECT_EQ(said_to({"--value=-3"}, count, {-3, 9}), "");
    EXPECT_EQ(count, -3);
}

TEST(CommandLine, NonFiniteNumberErrorNamesUnitAndRange) {
    double length = 7.0;
    for (const char* const typed : {"nan", "NaN", "-nan", "inf", "-inf", "infinity", "", " 1", "1 ", "0x10",
                                    "1,5", "five", "--", "1e999", "-1e999", "+-1", "1e", "5mm", "5 mm"}) {
        const std::string said = said_to({std::string("--value=") + typed}, length, {0.0, 30.0, "mm"});
        if (*typed == '\0') {
            EXPECT_NE(said, "");
            continue;
        }
        EXPECT_NE(said.find("expected a number, 0 to 30 mm"), std::string::npos) << typed << ": " << said;
        EXPECT_NE(said.find("--value"), std::string::npos) << said;
    }
    EXPECT_EQ(length, 7.0);
}

TEST(CommandLine, CountsThatWouldWrapAroundAreRefused) {
    std::uint64_t steps = 7;
    int threads = 7;
    for (const char* const typed : {"-1", "-0.5", "1.5", "18446744073709551616", "nan", "1e3"}) {
        EXPECT_NE(said_to({std::string("--value=") + typed}, steps, {1}), "") << typed;
        EXPECT_NE(said_to({std::string("--value=") + typed}, threads, {0, 256}), "") << typed;
    }
    EXPECT_NE(said_to({"--value", "4294967297"}, threads, {0, 256}), "");  // 1 in 32 bits
    EXPECT_EQ(steps, 7u);
    EXPECT_EQ(threads, 7);
}

TEST(CommandLine, MessagesAreShortAndShowNoControlCharacters) {
    double time = 0.0;
    const std::string huge = said_to({"--value", "1e308"}, time, {0.0, 3600.0, "s"});
    EXPECT_EQ(huge, "--value: '1e308' is too large; expected a number, 0 to 3600 s");
    const std::string escape =
        said_to({"--value", "\x1b[31m" + std::string(500, '9')}, time, {0.0, 3600.0, "s"});
    EXPECT_LT(escape.size(), 200u);
    EXPECT_EQ(escape.find('\x1b'), std::string::npos);
    EXPECT_NE(escape.find("\\x1b[31m999"), std::string::npos) << escape;
}

TEST(CommandLine, HelpShowsTheRange) {
    CommandLine app("A program.", "program");
    double length = 0.0;
    std::uint64_t seed = 0;
    app.add_number("--length-mm", length, "A length", {0.0, 30.0, "mm"});
    app.add_number("--seed", seed, "A seed", {0});
    const std::string text = help(app);
    EXPECT_NE(text.find("--length-mm NUMBER [0 to 30 mm]"), std::string::npos) << text;
    EXPECT_NE(text.find("--seed COUNT [0 to 18446744073709551615]"), std::string::npos) << text;
}

TEST(CommandLine, WithoutExtraArgsTheNextWordIsPositional) {
    CommandLine app("A program.", "program");
    std::vector<std::string> values;
    std::string rest;
    app.add_option("--value", values, "Values").allow_extra_args(false);
    app.add_option("REST", rest, "The rest");
    EXPECT_EQ(refusal(app, {"--value", "a", "--value", "b", "c"}), "");
    EXPECT_EQ(values, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(rest, "c");
    EXPECT_NE(help(app).find("--value TEXT ..."), std::string::npos) << help(app);
}

TEST(CommandLine, RepeatableKeepsAllValues) {
    CommandLine app("A program.", "program");
    std::vector<std::string> values;
    app.add_option("--value", values, "Values").repeatable();
    EXPECT_EQ(refusal(app, {"--value", "a", "--value", "b"}), "");
    EXPECT_EQ(values, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(help(app).find("--value TEXT ..."), std::string::npos) << help(app);
}

TEST(CommandLine, OptionsNeedAndExcludeOthers) {
    bool fast = false, by_clock = false, paused = false, given = true;
    const auto said = [&](const std::vector<std::string>& arguments) {
        CommandLine app("A program.", "program");
        const Option option = app.add_flag("--fast", fast, "Fast");
        app.add_flag("--clock", by_clock, "By the clock").excludes({"--fast"});
        app.add_flag("--pause", paused, "Paused").needs(option);
        std::string text = refusal(app, arguments);
        given = !option.empty();
        return text;
    };
    EXPECT_EQ(said({"--clock", "--fast"}), "--fast excludes --clock");
    EXPECT_EQ(said({"--pause"}), "--pause requires --fast");
    EXPECT_FALSE(given);
    EXPECT_EQ(said({"--pause", "--fast"}), "");
    EXPECT_TRUE(given);
}

TEST(CommandLine, ExcludingAnUndeclaredOptionThrows) {
    CommandLine app("A program.", "program");
    bool flag = false;
    EXPECT_THROW(app.add_flag("--flag", flag, "A flag").excludes({"--none"}), std::runtime_error);
    EXPECT_THROW((void)app.option("--none"), std::runtime_error);
}

TEST(CommandLine, WordsOutsideTheSetAreRefused) {
    CommandLine app("A program.", "program");
    std::string tool;
    app.add_option("--tool", tool, "A tool").one_of({"tube", "blade"});
    EXPECT_EQ(refusal(app, {"--tool", "fork"}), "--tool: fork not in {tube,blade}");
    EXPECT_EQ(refusal(app, {"--tool", "tube"}), "");
    EXPECT_NE(help(app).find("--tool TEXT:{tube,blade}"), std::string::npos) << help(app);
}

TEST(CommandLine, SubcommandsOutliveTheirParentsHandle) {
    bool json = false;
    std::vector<std::string> files;
    const auto declared = [&] {
        CommandLine app("A program.", "program");
        app.require_subcommand(1);
        app.fallthrough();
        app.add_flag("--json", json, "As JSON");
        CommandLine check = app.add_subcommand("check", "Checks");
        check.add_option("FILE", files, "Files").required();
        return std::pair(app, check);
    };
    {
        auto [app, check] = declared();
        EXPECT_EQ(refusal(app, {"check", "a", "b", "--json"}), "");
        EXPECT_TRUE(check.parsed());
        EXPECT_TRUE(json);
        EXPECT_EQ(files, (std::vector<std::string>{"a", "b"}));
    }
    CommandLine check = declared().second;
    EXPECT_EQ(check.name(), "check");
    EXPECT_FALSE(check.parsed());
    auto app = declared().first;
    EXPECT_EQ(refusal(app, {}), "A subcommand is required");
}

TEST(CommandLine, UnknownWordsAreKeptIfExtrasAreAllowed) {
    CommandLine app("A program.", "program");
    CommandLine replay = app.add_subcommand("replay", "Replays");
    EXPECT_EQ(refusal(app, {"replay", "--session", "a"}),
              "The following arguments were not expected: a --session");
    replay.allow_extras();
    EXPECT_EQ(refusal(app, {"replay", "--session", "a"}), "");
    EXPECT_EQ(replay.remaining(), (std::vector<std::string>{"--session", "a"}));
}

TEST(CommandLine, CallbackMayRefuseTheCommandLine) {
    bool loop = false, replay = false;
    int calls = 0;
    CommandLine app("A program.", "program");
    app.add_flag("--loop", loop, "Again");
    app.add_flag("--replay", replay, "Of a file");
    app.callback([&] {
        ++calls;
        if (loop && !replay) {
            throw UsageError("--loop requires --replay");
        }
    });
    EXPECT_EQ(refusal(app, {"--loop"}), "--loop requires --replay");
    EXPECT_EQ(refusal(app, {"--loop", "--replay"}), "");
    EXPECT_EQ(calls, 2);
    EXPECT_NE(refusal(app, {"--loo"}), "");
    EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace eti
