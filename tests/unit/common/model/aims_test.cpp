// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/model/aims.hpp"

namespace eti {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const Aim& aim(std::string_view key) {
    return *std::ranges::find(aims, key, &Aim::key);
}

Light light(std::string_view key, const Parameters& values, const Parameters& first = starting_parameters()) {
    return light_of(shortfall(aim(key), values, first));
}

TEST(Aims, EachBelongsToAParameterThatNamesItsSource) {
    for (const Aim& one : aims) {
        const auto field = std::ranges::find(parameter_fields, one.key, &ParameterField::key);
        ASSERT_NE(field, parameter_fields.end()) << one.key;
        EXPECT_FALSE(field->norm.empty()) << one.key;
        EXPECT_LE(one.reached, one.near) << one.key;
    }
}

// And the other way round: no parameter has an aim in words that no light knows.
TEST(Aims, EveryNormHasAnAim) {
    for (const ParameterField& field : parameter_fields) {
        EXPECT_EQ(field.norm.empty(), std::ranges::find(aims, field.key, &Aim::key) == aims.end())
            << field.key;
    }
}

TEST(Aims, AValueAtItsAimReachesIt) {
    Parameters p = starting_parameters();
    p.time_s = 30;
    EXPECT_EQ(light("time_s", p), Light::reached);
    p.time_s = 30.1;
    EXPECT_EQ(light("time_s", p), Light::near);
    p.time_s = 45.1;
    EXPECT_EQ(light("time_s", p), Light::missed);
    p.oesophageal_entries = 1;
    EXPECT_EQ(light("oesophageal_entries", p), Light::missed);
}

TEST(Aims, TheTubesDepthIsHeldAgainstTheWeightRuleOnBothSides) {
    Parameters p = starting_parameters();
    p.tube_depth_rule_cm = 9.5;
    for (const double depth : {9.1, 9.9}) {
        p.tube_depth_at_lip_cm = depth;
        EXPECT_EQ(light("tube_depth_at_lip_cm", p), Light::reached) << depth;
    }
    for (const double depth : {8.4, 10.6}) {
        p.tube_depth_at_lip_cm = depth;
        EXPECT_EQ(light("tube_depth_at_lip_cm", p), Light::missed) << depth;
    }
}

// Herrick et al. 2020: a fall by 20 points, from whatever the session began with.
TEST(Aims, SaturationIsMeasuredFromItsBeginning) {
    Parameters first = starting_parameters(), p = first;
    first.oxygen_saturation_end_percent = 90;
    p.oxygen_saturation_min_percent = 85;
    EXPECT_EQ(light("oxygen_saturation_percent.min", p, first), Light::reached);
    p.oxygen_saturation_min_percent = 69;
    EXPECT_EQ(light("oxygen_saturation_percent.min", p, first), Light::missed);
}

TEST(Aims, WhatDoesNotExistHasNoLight) {
    Parameters p;
    for (const ParameterField& field : parameter_fields) {
        p.*field.value = nan;
    }
    for (const Aim& one : aims) {
        EXPECT_EQ(light_of(shortfall(one, p, p)), Light::unknown) << one.key;
    }
}

TEST(Aims, AForceWithoutPublishedLimitIsNeverCalledMissed) {
    Parameters p = starting_parameters();
    p.gum_force_max_n = 1000;
    EXPECT_EQ(light("gum_force_n.max", p), Light::near);
    p.gum_force_max_n = 5.3;
    EXPECT_EQ(light("gum_force_n.max", p), Light::reached);
}

}  // namespace
}  // namespace eti
