// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

// Nine levels of nine references each: 9^9 nodes if they were expanded.
std::string alias_bomb() {
    std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
    for (char level = '1'; level <= '9'; ++level) {
        text.append("a").append(1, level).append(": &a").append(1, level).append(" [");
        for (int k = 0; k < 9; ++k) {
            text.append(k > 0 ? ", *a" : "*a").append(1, static_cast<char>(level - 1));
        }
        text.append("]\n");
    }
    return text;
}

std::string repeated(const std::string& part, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) {
        text += part;
    }
    return text;
}

std::string many_keys() {
    std::string text;
    for (int i = 0; i < 100'000; ++i) {
        text.append("k").append(std::to_string(i)).append(":\n");
    }
    return text;
}

std::vector<std::pair<std::string, std::string>> hostile() {
    return {
        {"empty", ""},
        {"blank", "  \n\n"},
        {"comment", "# nothing\n"},
        {"nothing", "~\n"},
        {"scalar", "42\n"},
        {"list", "- 1\n- 2\n"},
        {"unclosed", "patient: {weight_kg: 3.5"},
        {"unclosed quote", "name: \"baby\n"},
        {"unclosed quote before other keys", "description: \"baby\npatient:\n  weight_kg: 3\n"},
        {"unclosed single quote", "description: 'it''s\nseed: 1\n"},
        {"unclosed quote after an escaped one", "description: \"so \\\"\nseed: 1\n"},
        {"byte order mark", "\xef\xbb\xbfseed: 1\n"},
        {"tabs", "patient:\n\tweight_kg: 3.5\n"},
        {"two documents", "---\n{}\n---\n{}\n"},
        {"a document and rubbish", "{}\n---\n[[[\n"},
        {"zeros", std::string(4096, '\0')},
        {"not UTF-8", "name: \xff\xfe\x80\n"},
        {"cut letter", "name: \xc3"},
        {"UTF-16", std::string("s\0e\0e\0d\0:\0 \0001\0", 14)},
        {"escape codes", "name: \x1b[31mred\n"},
        {"deep lists", std::string(20'000, '[')},
        {"deep maps", repeated("{a: ", 20'000)},
        {"deep blocks", repeated("- ", 20'000)},
        {"deep keys", repeated("? ", 20'000)},
        {"alias bomb", alias_bomb()},
        {"anchor", "seed: &s 1\n"},
        {"merge with itself", "patient: &p\n  <<: *p\n"},
        {"alias without anchor", "seed: *s\n"},
        {"foreign tag", "patient: !!python/object/apply:os.system ['true']\n"},
        {"tagged number", "seed: !!int 3\n"},
        {"binary tag", "name: !!binary aGVsbG8=\n"},
        {"list as key", "? [1, 2]\n: 3\n"},
        {"mapping as key", "{{a: 1}: 2}\n"},
        {"long key", std::string(500'000, 'k') + ": 1\n"},
        {"long name", "name: " + std::string(500'000, 'n') + "\n"},
        {"long description", "description: " + std::string(500'000, 'n') + "\n"},
        {"many keys", many_keys()},
        {"long list", "name: [" + repeated("1, ", 200'000) + "1]\n"},
    };
}

TEST(HostileScenario, IsRefusedBrieflyAndQuickly) {
    for (const auto& [name, text] : hostile()) {
        const std::clock_t begin = std::clock();
        const std::string message =
            test::error_of<InputError>([&] { (void)parse_scenario(text, "evil.yaml"); });
        const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;  // processor time
        EXPECT_EQ(message.rfind("evil.yaml", 0), 0u) << name << ": " << message;
        EXPECT_LT(message.size(), 1000u) << name << " is shown whole";
        EXPECT_LT(took, 5.0) << name << " takes too long";
    }
}

TEST(HostileScenario, ClosedQuotesAreAccepted) {
    const Scenario s =
        parse_scenario("name: \"a \\\"b\\\" \xc3\xa4 c\"\r\ndescription: 'it''s'\r\nseed: 1\r\n", "x.yaml");
    EXPECT_EQ(s.name, "a \"b\" \xc3\xa4 c");
    EXPECT_EQ(s.description, "it's");
    EXPECT_EQ(parse_scenario("{name: \"a\", description: 'x'}", "x.yaml").name, "a");
}

TEST(HostileScenario, ErrorsAreValidUtf8) {
    // A long value of two-byte letters is cut between letters, so that the message is valid in JSON.
    std::string letters;
    for (int i = 0; i < 100; ++i) {
        letters += "\xc3\xa4";
    }
    for (const std::string& lead : {std::string(), std::string("x")}) {
        try {
            (void)parse_scenario("saliva: " + lead + letters + "\n", "evil.yaml");
            FAIL();
        } catch (const InputError& error) {
            const std::string message = error.what();
            const std::size_t cut = message.find("...");
            ASSERT_NE(cut, std::string::npos);
            EXPECT_EQ(message[cut - 1], '\xa4') << "cut inside a letter";
        }
    }
}

}  // namespace
}  // namespace eti
