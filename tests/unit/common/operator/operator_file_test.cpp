// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/math/units.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/data_file.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

const std::string stage = "laryngoscope:\n  - stage: first\n";

std::string refusal(const std::string& text) {
    return test::error_of<InputError>([&] { (void)parse_operator(text, "hand.yaml"); });
}

bool says(const std::string& message, std::initializer_list<const char*> words) {
    return std::all_of(words.begin(), words.end(),
                       [&](const char* word) { return message.find(word) != std::string::npos; });
}

TEST(OperatorFile, EveryKeyArrivesInItsUnit) {
    const OperatorScript script = parse_operator(R"(
name: steady
description: tries every key
tremor_mm: 0.25
reaction_s: 0.3
lean_mm: 6
seed: 18446744073709551615
patient_weight_kg: 1.25
laryngoscope:
  - stage: everything
    follow: on
    tip: {at: epiglottis_tip, offset_mm: [1, -2, 3.5], fixed_offset_mm: [0, 6, -1]}
    axis: {from: lower_gum, from_offset_mm: [-1, 2, 0], from_fixed_offset_mm: [0, -5, 2], to: glottis}
    lift_mm: 8
    advance_mm: -4
    pitch_deg: 10
    yaw_deg: -5
    roll_deg: 90
    pivot: lower_gum
    speed_mm_per_s: 55
    hold_s: 1.5
    until: {view_percent: 60, tube_depth_mm: 22, blade_past_mm: 6, time_s: 12}
    timeout_s: 7
    abort_on_timeout: true
  - {stage: kept, keep: on}
tube:
  - {stage: in, depth_at_lip_mm: 95, steer: on, until: {tube_aside_mm: 1.5}}
  - {stage: by weight, keep: on, depth_by_rule: on}
)",
                                                 "hand.yaml");
    EXPECT_EQ(script.name, "steady");
    EXPECT_EQ(script.description, "tries every key");
    EXPECT_FLOAT_EQ(script.tremor, 0.25e-3f);
    EXPECT_FLOAT_EQ(script.reaction, 0.3f);
    EXPECT_FLOAT_EQ(script.laryngoscope.lean, 6e-3f);
    EXPECT_EQ(script.tube.lean, 0.0f);
    EXPECT_EQ(script.seed, 18446744073709551615ull);
    ASSERT_EQ(script.laryngoscope.stages.size(), 2u);
    const Stage& s = script.laryngoscope.stages[0];
    EXPECT_EQ(s.name, "everything");
    EXPECT_TRUE(s.follow);
    EXPECT_FALSE(s.keep);
    EXPECT_EQ(s.tip_at, Landmark::epiglottis_tip);
    EXPECT_TRUE(s.tip_offset.isApprox(Vec3f(1e-3f, -2e-3f, 3.5e-3f)));
    EXPECT_EQ(s.axis_from, Landmark::lower_gum);
    EXPECT_TRUE(s.axis_from_offset.isApprox(Vec3f(-1e-3f, 2e-3f, 0)));
    EXPECT_TRUE(s.tip_fixed_offset.isApprox(Vec3f(0, 6e-3f, -1e-3f)));
    EXPECT_TRUE(s.axis_from_offset.isApprox(Vec3f(-1e-3f, 2e-3f, 0)));
    EXPECT_TRUE(s.axis_from_fixed_offset.isApprox(Vec3f(0, -5e-3f, 2e-3f)));
    EXPECT_FALSE(s.axis_to_tip);
    EXPECT_EQ(s.axis_to, Landmark::glottis);
    EXPECT_FLOAT_EQ(s.lift, 8e-3f);
    EXPECT_FLOAT_EQ(s.advance, -4e-3f);
    EXPECT_FLOAT_EQ(s.pitch, 10 * degree);
    EXPECT_FLOAT_EQ(s.yaw, -5 * degree);
    EXPECT_FLOAT_EQ(s.roll, 90 * degree);
    EXPECT_FALSE(s.pivot_at_tip);
    EXPECT_EQ(s.pivot, Landmark::lower_gum);
    EXPECT_FLOAT_EQ(s.speed, 0.055f);
    EXPECT_FLOAT_EQ(s.hold, 1.5f);
    EXPECT_FLOAT_EQ(s.until_view_percent, 60);
    EXPECT_FLOAT_EQ(s.until_tube_depth, 0.022f);
    EXPECT_FLOAT_EQ(s.until_blade_past, 6e-3f);
    EXPECT_FLOAT_EQ(s.until_time, 12);
    EXPECT_FLOAT_EQ(s.timeout, 7);
    EXPECT_TRUE(s.abort_on_timeout);
    EXPECT_TRUE(script.laryngoscope.stages[1].keep);
    EXPECT_TRUE(script.laryngoscope.stages[1].pivot_at_tip);
    EXPECT_FLOAT_EQ(script.tube.stages[0].depth_at_lip, 0.095f);
    EXPECT_TRUE(script.tube.stages[0].steer);
    EXPECT_FLOAT_EQ(script.tube.stages[0].until_tube_aside, 1.5e-3f);
    EXPECT_FALSE(script.tube.stages[1].steer);
    EXPECT_TRUE(script.tube.stages[1].depth_by_rule);
    EXPECT_FLOAT_EQ(script.laryngoscope.weight, 1.25f);
    EXPECT_FLOAT_EQ(script.tube.weight, 1.25f);
}

TEST(OperatorFile, NameDefaultsToTheFileName) {
    EXPECT_EQ(parse_operator(stage, "folder/hand.yaml").name, "hand");
}

TEST(OperatorFile, UnknownLandmarkListsTheKnown) {
    EXPECT_TRUE(says(refusal(stage + "    tip: {at: uvula}\n"),
                     {"hand.yaml:3", "laryngoscope[0].tip.at", "'uvula'", "vallecula", "oesophagus_mid"}));
}

TEST(OperatorFile, MisspeltKeyGetsASuggestion) {
    EXPECT_TRUE(says(refusal(stage + "    speed_mm_pers: 30\n"),
                     {"hand.yaml:3", "speed_mm_pers", "did you mean 'speed_mm_per_s'?"}));
}

TEST(OperatorFile, ContradictionsAreRefused) {
    EXPECT_TRUE(says(refusal(stage + "    keep: on\n"), {"keep", "first stage"}));
    const std::string kept = stage + "  - stage: second\n    keep: on\n";
    EXPECT_EQ(refusal(kept), "");
    EXPECT_TRUE(says(refusal(kept + "    tip: {at: glottis}\n"), {"hand.yaml:5", "tip", "keep"}));
    EXPECT_TRUE(says(refusal(kept + "    axis: {from: glottis}\n"), {"axis", "keep"}));
    EXPECT_TRUE(says(refusal(kept + "    follow: on\n"), {"follow", "keep"}));
    EXPECT_TRUE(says(refusal(stage + "    depth_at_lip_mm: 90\n    depth_by_rule: on\n"), {"depth_by_rule"}));
    EXPECT_TRUE(says(refusal(stage + "    steer: on\n"), {"hand.yaml:3", "steer", "laryngoscope", "tube"}));
    const std::string tube = "tube:\n  - stage: first\n";
    EXPECT_EQ(refusal(tube + "    steer: on\n    until: {tube_aside_mm: 1}\n"), "");
    EXPECT_TRUE(says(refusal(tube + "    until: {tube_aside_mm: 1}\n"), {"tube_aside_mm", "steer"}));
    EXPECT_TRUE(says(refusal(tube + "  - {stage: second, keep: on, steer: on}\n"), {"steer", "keep"}));
    const std::string past = "    until: {blade_past_mm: 6}\n";
    EXPECT_EQ(refusal(stage + past), "");
    EXPECT_TRUE(says(refusal(kept + past), {"blade_past_mm", "laryngoscope", "'tip'"}));
    EXPECT_TRUE(says(refusal(tube + past), {"blade_past_mm", "laryngoscope", "'tip'"}));
}

TEST(OperatorFile, AxisOfZeroLengthIsRefused) {
    EXPECT_TRUE(
        says(refusal(stage + "    axis: {from: glottis, to: glottis}\n"), {"hand.yaml:3", "to", "from"}));
    EXPECT_EQ(refusal(stage + "    axis: {from: glottis, from_offset_mm: [0, 0, 20], to: glottis}\n"), "");
    EXPECT_EQ(refusal(stage + "    axis: {from: glottis}\n"), "")
        << "to the tip, which lies where it is asked";
}

TEST(OperatorFile, ScriptWithoutStagesIsRefused) {
    EXPECT_TRUE(says(refusal("name: idle\n"), {"laryngoscope", "tube"}));
    EXPECT_TRUE(says(refusal("laryngoscope: {stage: x}\n"), {"laryngoscope", "list"}));
    EXPECT_TRUE(says(refusal("laryngoscope:\n  - hold_s: 1\n"), {"stage", "name"}));
}

TEST(OperatorFile, OffsetsNeedThreeNumbers) {
    EXPECT_TRUE(says(refusal(stage + "    tip: {offset_mm: [1, 2]}\n"), {"offset_mm", "2 entries"}));
    EXPECT_TRUE(
        says(refusal(stage + "    tip: {offset_mm: 5}\n"), {"offset_mm", "left, posterior, superior"}));
    EXPECT_TRUE(says(refusal(stage + "    tip: {offset_mm: [1, 2, far]}\n"), {"offset_mm", "'far'"}));
    EXPECT_TRUE(says(refusal(stage + "    tip: {offset_mm: [1, 2, [3]]}\n"), {"offset_mm"}));
}

}  // namespace
}  // namespace eti
