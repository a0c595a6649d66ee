// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/skill.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/operator/track_player.hpp"
#include "tests/unit/common/operator/newborn_landmarks.hpp"

namespace eti {
namespace {

OperatorScript script(float skill, int attempts = 1) {
    OperatorScript s = parse_operator(R"(
name: hand
laryngoscope:
  - {stage: in, tip: {at: vallecula}, axis: {from: upper_gum}}
  - {stage: lift, keep: on, lift_mm: 8, pivot: upper_gum}
  - {stage: out, tip: {at: mouth_opening, offset_mm: [0, -40, 20]}, axis: {from: mouth_opening, from_offset_mm: [0, -80, 40]}}
tube:
  - {stage: wait, tip: {at: mouth_opening, offset_mm: [-14, -30, 26]}, axis: {from: upper_gum, to: glottis}, until: {view_percent: 40}}
  - {stage: through, tip: {at: glottis}, axis: {from: upper_gum}, steer: on, until: {tube_depth_mm: 24}, timeout_s: 1}
)",
                                      "hand.yaml");
    s.skill = skill;
    s.attempts = attempts;
    return s;
}

TEST(Skill, FullSkillPlaysTheScriptUnchanged) {
    const OperatorScript written = script(1.0f);
    const OperatorScript played = make_attempts(written, 5).front();
    EXPECT_EQ(played.tremor, written.tremor);
    EXPECT_EQ(played.reaction, written.reaction);
    EXPECT_EQ(played.tube.steering, 1.0f);
    for (std::size_t i = 0; i < written.laryngoscope.stages.size(); ++i) {
        const Stage &a = written.laryngoscope.stages[i], &b = played.laryngoscope.stages[i];
        EXPECT_EQ(a.tip_fixed_offset, b.tip_fixed_offset);
        EXPECT_EQ(a.speed, b.speed);
        EXPECT_EQ(a.hold, b.hold);
        EXPECT_EQ(a.lift, b.lift);
        EXPECT_EQ(a.pitch, b.pitch);
    }
    EXPECT_EQ(played.tube.stages[1].until_tube_depth, written.tube.stages[1].until_tube_depth);
}

TEST(Skill, VariationDependsOnSeedAlone) {
    const auto aim = [](std::uint64_t seed) -> Vec3f {
        return make_attempts(script(0.5f), seed).front().laryngoscope.stages[0].tip_fixed_offset;
    };
    EXPECT_EQ(aim(3), aim(3));
    EXPECT_NE(aim(3), aim(4));
}

// Samples have the script's spread, and half of it at half the skill. References: an aim's offset is the sum
// of two normal numbers, of path and of 0.3 path; a pause is exponential; the missing share of the lift is
// the absolute value of a normal number, limited to 1.
TEST(Skill, VariationHasTheScriptsSpread) {
    constexpr int draws = 1500;
    const Variation by;
    for (const float skill : {0.0f, 0.5f}) {
        const double lack = 1.0 - static_cast<double>(skill);
        double squares = 0, pauses = 0, levers = 0, depths = 0;
        for (int i = 0; i < draws; ++i) {
            const OperatorScript played =
                make_attempts(script(skill), 100 + static_cast<std::uint64_t>(i)).front();
            squares += std::pow(static_cast<double>(played.laryngoscope.stages[0].tip_fixed_offset.x()), 2);
            pauses += static_cast<double>(played.tube.stages[0].hold);
            levers += std::pow(static_cast<double>(played.laryngoscope.stages[1].pitch), 2);
            depths += std::pow(static_cast<double>(played.tube.stages[1].until_tube_depth) - 24e-3, 2);
        }
        // Four standard errors: for a normal number's spread 1 / sqrt(2 n), for an exponential one's mean 1 /
        // sqrt(n).
        const double of_spread = 4.0 / std::sqrt(2.0 * draws), of_mean = 4.0 / std::sqrt(draws);
        const double path = lack * static_cast<double>(by.path) * std::sqrt(1.09);
        EXPECT_NEAR(std::sqrt(squares / draws), path, path * of_spread);
        EXPECT_NEAR(pauses / draws, lack * static_cast<double>(by.pause),
                    static_cast<double>(by.pause) * of_mean);
        const double lever = lack * static_cast<double>(by.lever);
        EXPECT_NEAR(std::sqrt(levers / draws), lever, lever * of_spread);
        // At no skill 5 % of the depths are clamped at 0.
        const double depth = lack * static_cast<double>(by.depth);
        EXPECT_NEAR(std::sqrt(depths / draws), depth, depth * (of_spread + (skill == 0.0f ? 0.05 : 0.0)));
    }
}

/// Plays a hand until it is done, with the other tool out of the mouth; returns its number of attempts.
std::size_t attempts_made(Tool tool, const OperatorScript& of, float depth_past_glottis,
                          double until = 200.0) {
    const float length = 0.1f;
    TrackPlayer player(of, tool, length, 0.0f, 1);
    Observation seen;
    seen.landmarks = newborn_landmarks();
    const Vec3f away = at(seen.landmarks, Landmark::mouth_opening) + Vec3f(0, -0.3f, 0);
    seen.tube_tip = away;
    seen.proxy.translation = away;
    seen.tube_depth_past_glottis = depth_past_glottis;
    for (; !player.finished() && seen.time < until; seen.time += 5e-3) {
        const RigidTransform pose = player.wanted(seen);
        (tool == Tool::tube ? seen.tube_tip = pose * Vec3f(0, 0, length) : (seen.proxy = pose).translation);
    }
    EXPECT_TRUE(player.finished());
    return player.attempt();
}

TEST(Skill, RetriesUntilTubeIsInTheTrachea) {
    for (const Tool tool : {Tool::laryngoscope, Tool::tube}) {
        EXPECT_EQ(attempts_made(tool, script(1.0f, 3), -0.02f), 3u);
        EXPECT_EQ(attempts_made(tool, script(0.3f, 3), -0.02f), 3u);
        EXPECT_EQ(attempts_made(tool, script(1.0f, 3), 0.02f), 1u) << "intubated";
        EXPECT_EQ(attempts_made(tool, script(1.0f, 1), -0.02f), 1u) << "one attempt";
    }
}

// A blade that stays in the mouth keeps the tube's hand from trying again, but only up to a time limit.
TEST(Skill, EndsWhenOtherHandIsNotWithdrawn) {
    TrackPlayer player(script(1.0f, 3), Tool::tube, 0.1f, 0.0f, 1);
    Observation seen;
    seen.landmarks = newborn_landmarks();
    seen.tube_tip = at(seen.landmarks, Landmark::mouth_opening);
    seen.proxy.translation = seen.tube_tip - Vec3f(0.0f, 0.0f, 0.09f);  // the blade's front is inside
    for (; !player.finished() && seen.time < 120.0; seen.time += 5e-3) {
        (void)player.wanted(seen);
    }
    EXPECT_TRUE(player.finished());
    EXPECT_EQ(player.attempt(), 1u);
}

TEST(Skill, RetryWithdrawsTheTubeFirst) {
    const std::vector<OperatorScript> attempts = make_attempts(script(1.0f, 2), 1);
    ASSERT_EQ(attempts.size(), 2u);
    EXPECT_LT(attempts[0].tube.stages.front().withdraw, 0.0f);
    EXPECT_GT(attempts[1].tube.stages.front().withdraw, 0.0f);
    // From 60 mm inside, along the tool, to 30 mm in front of the mouth opening; a tool outside stays.
    Track track;
    Stage in;
    in.name = "in";
    in.tip_at = Landmark::glottis;
    in.axis_from = Landmark::mouth_opening;
    track.stages = {in, attempts[1].tube.stages.front()};
    TrackPlayer player(track, 0.1f, 0.0f, 0.2f, 1);
    Observation seen;
    seen.landmarks = newborn_landmarks();
    RigidTransform pose;
    for (; !player.finished(); seen.time += 5e-3) {
        pose = player.wanted(seen);
    }
    const Vec3f to_glottis =
        (at(seen.landmarks, Landmark::glottis) - at(seen.landmarks, Landmark::mouth_opening)).normalized();
    const Vec3f tip = pose * Vec3f(0, 0, 0.1f) - at(seen.landmarks, Landmark::mouth_opening);
    EXPECT_NEAR(tip.dot(to_glottis), -0.03f, 1e-4f);
}

}  // namespace
}  // namespace eti
