// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/command_line.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

/// What a program says to these arguments; empty where it takes them.
template <class Value>
std::string said_to(const std::vector<std::string>& arguments, Value& value,
                    const NumberLimits<typename NumberOf<Value>::type>& limits) {
    CLI::App app("A program.", "program");
    add_number(app, "--value", value, "A value", limits);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    try {
        app.parse(reversed);
        return {};
    } catch (const CLI::ParseError& error) {
        return error.what();
    }
}

TEST(CommandLine, TakesNumbersWithinTheirLimitsBothEndsIncluded) {
    double length = -1.0;
    for (const auto& [typed, read] : std::vector<std::pair<std::string, double>>{
             {"0", 0.0}, {"30", 30.0}, {"+0.25", 0.25}, {"1e1", 10.0}, {"007", 7.0}, {".5", 0.5}}) {
        EXPECT_EQ(said_to({"--value", typed}, length, {0.0, 30.0, "mm"}), "") << typed;
        EXPECT_EQ(length, read) << typed;
    }
    // A limit that binary numbers only come near to is still within.
    float share = 0.0f;
    EXPECT_EQ(said_to({"--value", "0.1"}, share, {0.1f, 0.7f}), "");
    EXPECT_EQ(said_to({"--value", "0.7"}, share, {0.1f, 0.7f}), "");
    EXPECT_EQ(share, 0.7f);
}

TEST(CommandLine, WholeNumbersAreReadInDecimalDigitsUpToTheirTypesEnds) {
    std::uint64_t seed = 1;
    EXPECT_EQ(said_to({"--value", "18446744073709551615"}, seed, {0}), "");
    EXPECT_EQ(seed, 18446744073709551615u);
    // The library would read octal digits.
    EXPECT_EQ(said_to({"--value", "010"}, seed, {0}), "");
    EXPECT_EQ(seed, 10u);
    std::optional<int> count;
    EXPECT_EQ(said_to({}, count, {0, 9}), "");
    EXPECT_EQ(count, std::nullopt);
    EXPECT_EQ(said_to({"--value=-3"}, count, {-3, 9}), "");
    EXPECT_EQ(count, -3);
}

TEST(CommandLine, WhatIsNoFiniteNumberIsRefusedWithUnitAndRange) {
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

TEST(CommandLine, HelpTellsTheRange) {
    CLI::App app("A program.", "program");
    double length = 0.0;
    std::uint64_t seed = 0;
    add_number(app, "--length-mm", length, "A length", {0.0, 30.0, "mm"});
    add_number(app, "--seed", seed, "A seed", {0});
    EXPECT_NE(app.help().find("--length-mm NUMBER [0 to 30 mm]"), std::string::npos) << app.help();
    EXPECT_NE(app.help().find("--seed COUNT [0 to 18446744073709551615]"), std::string::npos) << app.help();
}

}  // namespace
}  // namespace eti
