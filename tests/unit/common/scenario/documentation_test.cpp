// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"

namespace eti {
namespace {

std::string page(const std::string& name) {
    std::ifstream in(std::string(ETI_SOURCE_DIR "/docs/") + name);
    return {std::istreambuf_iterator<char>(in), {}};
}

// The keys in the first column of a page's tables.
std::set<std::string> documented(const std::string& text) {
    std::set<std::string> keys;
    std::istringstream lines(text);
    std::string line;
    bool in_keys = false;
    while (std::getline(lines, line)) {
        in_keys = line.rfind("| key |", 0) == 0 || (in_keys && line.rfind("|", 0) == 0);
        const std::string cell = in_keys ? line.substr(1, line.find('|', 1) - 1) : "";
        for (std::size_t open = cell.find('`'); open != std::string::npos; open = cell.find('`', open)) {
            const std::size_t close = cell.find('`', open + 1);
            keys.insert(cell.substr(open + 1, close - open - 1));
            open = close + 1;
        }
    }
    return keys;
}

// The keys that the reader lists in its error for an unknown one.
template <class Parse>
void add_known(std::set<std::string>& keys, const std::string& prefix, const std::string& text, Parse parse) {
    try {
        (void)parse(text, "x.yaml");
        FAIL() << "'" << text << "' was accepted";
    } catch (const InputError& error) {
        const std::string message = error.what();
        const std::string lead = "expected one of: ";
        const std::size_t begin = message.find(lead);
        ASSERT_NE(begin, std::string::npos) << message;
        std::istringstream names(message.substr(begin + lead.size()));
        std::string name;
        while (std::getline(names, name, ',')) {
            keys.insert(prefix + name.substr(name.find_first_not_of(' ')));
        }
    }
}

// Keys that only hold others are not in the tables.
void remove(std::set<std::string>& keys, std::initializer_list<const char*> groups) {
    for (const char* group : groups) {
        EXPECT_EQ(keys.erase(group), 1u) << group;
    }
}

TEST(Documentation, ListsEveryKeyOfAScenarioAndNoOther) {
    std::set<std::string> known;
    add_known(known, "", "zzz: 1\n", parse_scenario);
    for (const std::string group : {"patient", "laryngoscope", "tube", "physics", "assistant", "view"}) {
        add_known(known, group + ".", group + ": {zzz: 1}\n", parse_scenario);
    }
    remove(known, {"patient", "laryngoscope", "tube", "physics", "assistant", "view"});
    EXPECT_EQ(documented(page("scenarios.md")), known);
}

TEST(Documentation, ListsEveryKeyOfAnOperatorAndNoOther) {
    std::set<std::string> known;
    const std::string stage = "tube:\n  - stage: x\n    ";
    add_known(known, "", stage + "hold_s: 1\nzzz: 1\n", parse_operator);
    add_known(known, "", stage + "zzz: 1\n", parse_operator);
    for (const std::string group : {"tip", "axis", "until"}) {
        add_known(known, group + ".", stage + group + ": {zzz: 1}\n", parse_operator);
    }
    add_known(known, "variation.", stage + "hold_s: 1\nvariation: {zzz: 1}\n", parse_operator);
    remove(known, {"tip", "axis", "until", "variation"});
    std::set<std::string> keys = documented(page("operators/keys.md"));
    EXPECT_EQ(keys, known);
}

TEST(Documentation, ExamplesAreAccepted) {
    const auto example = [](const std::string& text) {
        const std::size_t begin = text.find("```yaml\n") + 8;
        return text.substr(begin, text.find("```", begin) - begin);
    };
    EXPECT_EQ(parse_scenario(example(page("scenarios.md")), "x.yaml").name, "stiff_tongue");
    EXPECT_EQ(parse_operator(example(page("operators/README.md")), "x.yaml").name, "brief_look");
}

TEST(Documentation, NamesEveryLandmark) {
    const std::string text = page("operators/keys.md");
    const std::size_t begin = text.find("## Landmarks");
    ASSERT_NE(begin, std::string::npos);
    const std::string section = text.substr(begin, text.find("\n## ", begin + 1) - begin);
    std::set<std::string> named;
    for (std::size_t open = section.find('`'); open != std::string::npos; open = section.find('`', open)) {
        const std::size_t close = section.find('`', open + 1);
        named.insert(section.substr(open + 1, close - open - 1));
        open = close + 1;
    }
    EXPECT_EQ(named, std::set<std::string>(landmark_names.begin(), landmark_names.end()));
}

}  // namespace
}  // namespace eti
