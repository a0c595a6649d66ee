// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/study.hpp"
#include "common/scenario/data_file.hpp"
#include "tests/support/error_of.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <set>

namespace eti::review {
namespace {

class StudyFile : public ::testing::Test {
  protected:
    ~StudyFile() override { std::filesystem::remove(file); }
    Study load(const std::string& text) const {
        std::ofstream(file) << text;
        return load_study(file);
    }
    std::string refusal(const std::string& text) const {
        return eti::test::error_of<InputError>([&] { (void)load(text); });
    }
    std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("eti_study_file_" + std::to_string(::getpid()) + ".yaml");
};

TEST(BalancedOrders, AreBalancedInPositionAndSuccession) {
    for (std::size_t count = 1; count <= 7; ++count) {
        const auto orders = balanced_orders(count);
        ASSERT_EQ(orders.size(), count % 2 == 0 || count == 1 ? count : 2 * count);
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> at_place, neighbours;
        for (const auto& order : orders) {
            EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), count);
            for (std::size_t i = 0; i < count; ++i) {
                ++at_place[{order[i], i}];
                if (i > 0) {
                    ++neighbours[{order[i - 1], order[i]}];
                }
            }
        }
        EXPECT_EQ(at_place.size(), count * count);
        EXPECT_EQ(neighbours.size(), count * (count - 1));
        for (const auto& [key, times] : at_place) {
            EXPECT_EQ(times, orders.size() / count);
        }
        for (const auto& [key, times] : neighbours) {
            EXPECT_EQ(times, orders.size() / count);
        }
    }
}

TEST_F(StudyFile, LatinSquareOrdersConditions) {
    const Study study = load(
        "name: s\nseed: 7\nconditions: [{scenario: term}, {name: small, scenario: premature}]\n"
        "participants: [{count: 2, operator: expert}, {}]\n");
    ASSERT_EQ(study.participants.size(), 3u);
    EXPECT_EQ(study.participants[1].name, "P02");
    EXPECT_EQ(study.participants[1].seed, 8u);
    EXPECT_EQ(study.participants[2].operator_, "");
    const auto plan = plan_of(study);
    ASSERT_EQ(plan.size(), 6u);
    EXPECT_EQ(plan[0].condition->name, "term");
    EXPECT_EQ(plan[2].condition->name, "small");
    EXPECT_EQ(plan[2].file, std::filesystem::path("small/P02.eti.h5"));
    EXPECT_EQ(plan[3].place, 2u);
    Study listed = study;
    listed.latin_square = false;
    EXPECT_EQ(plan_of(listed)[2].condition->name, "term");
}

TEST_F(StudyFile, SkillIsInterpolatedAcrossParticipants) {
    const Study study = load(
        "name: s\nconditions: [{scenario: term}]\n"
        "participants: [{count: 3, operator: expert, skill: 0.5, skill_to: 1, attempts: 2}, {operator: "
        "expert, skill: 0.25}, {}]\n");
    ASSERT_EQ(study.participants.size(), 5u);
    const float skills[] = {0.5f, 0.75f, 1.0f, 0.25f};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(study.participants[i].skill, skills[i]);
    }
    EXPECT_EQ(study.participants[2].attempts, 2);
    EXPECT_EQ(study.participants[3].attempts, std::nullopt);
    EXPECT_EQ(study.participants[4].skill, std::nullopt);
    EXPECT_NE(refusal("conditions: [{scenario: term}]\nparticipants: [{skill: 0.5}]\n")
                  .find("human participants have"),
              std::string::npos);
}

TEST_F(StudyFile, FindsScenarioBesideStudyFile) {
    const auto scenario = file.parent_path() / ("eti_beside_" + std::to_string(::getpid()) + ".yaml");
    std::ofstream(scenario) << "{}\n";
    const Study study = load("conditions: [{name: here, scenario: " + scenario.filename().string() +
                             "}]\nparticipants: [{}]\n");
    std::filesystem::remove(scenario);
    EXPECT_EQ(study.conditions[0].scenario, scenario.string());
}

TEST_F(StudyFile, ErrorsNameFileAndWrongValue) {
    const std::string sound = "conditions: [{scenario: term}]\nparticipants: [{count: 2}]\n";
    EXPECT_EQ(refusal(sound), "");
    for (const char* wrong :
         {"participants: [{count: 2}]\n", "conditions: [{scenario: term}]\n",
          "conditions: [{scenario: term}, {scenario: term}]\nparticipants: [{count: 2}]\n",
          "conditions: [{name: ../up, scenario: term}]\nparticipants: [{count: 2}]\n",
          "conditions: [{scenario: term}]\nparticipants: [{count: 0}]\n",
          "conditions: [{scenario: term}]\nparticipants: [{count: 2}]\norder: random\n",
          "conditions: [{scenario: term}]\nparticipants: [{count: 2, who: me}]\n"}) {
        EXPECT_NE(refusal(wrong).find(file.string()), std::string::npos) << wrong << refusal(wrong);
    }
    EXPECT_NE(refusal(sound + "expect: [{measure: tiem_s, from: term, to: term, is: more}]\n").find("tiem_s"),
              std::string::npos);
    EXPECT_NE(refusal(sound + "expect: [{measure: time_s, from: term, to: other, is: more}]\n").find("other"),
              std::string::npos);
}

TEST_F(StudyFile, ShippedStudiesAreValid) {
    for (const std::string& name : data_names("studies")) {
        EXPECT_FALSE(plan_of(load_study(find_data_file(name, "studies"))).empty()) << name;
    }
    EXPECT_GE(data_names("studies").size(), 1u);
}

TEST(Verdicts, FollowIntervalInEitherGroupOrder) {
    Comparison comparison;
    comparison.groups = {{"a", {}}, {"b", {}}};
    const Measure& time = measures()[9];
    ASSERT_EQ(time.key, "time_s");
    const auto with = [&](double difference, double low, double high) {
        comparison.rows = {{&time, {{3, 10.0, 1.0}, {3, 10.0 + difference, 1.0}}, {{0, 1, 0, {}, 0.5}}}};
        comparison.rows[0].contrasts[0].difference.value = difference;
        comparison.rows[0].contrasts[0].difference.interval = {low, high};
    };
    const auto word = [&](Expectation expected) {
        return check_expectations(comparison, {expected})[0].finding;
    };
    Expectation more{"time_s", "", "a", "b", true, "", no_value, no_value};
    Expectation back = more, less = more;
    std::swap(back.from, back.to);
    less.more = false;
    using enum ExpectationResult::Finding;
    with(4.0, 1.0, 7.0);
    EXPECT_EQ(word(more), agrees);
    EXPECT_EQ(word(less), disagrees);
    EXPECT_EQ(word(back), disagrees);
    EXPECT_EQ(check_expectations(comparison, {back})[0].found, "-4.00 (-7.00 to -1.00)");
    with(-4.0, -7.0, -1.0);
    EXPECT_EQ(word(more), disagrees);
    EXPECT_EQ(word(less), agrees);
    EXPECT_EQ(word(back), agrees);
    with(4.0, -1.0, 7.0);
    EXPECT_EQ(word(more), undecided);
    Expectation range{"time_s", "", "", "", true, "b", 13.0, 15.0};
    EXPECT_EQ(word(range), agrees);
    range.high = 13.5;
    EXPECT_EQ(word(range), disagrees);
    range.measure = "attempts";
    EXPECT_EQ(word(range), not_measured);
}

}  // namespace
}  // namespace eti::review
