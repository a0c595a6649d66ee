// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/runtime_parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace eti {
namespace {

TEST(RuntimeParameterTable, DefaultsLieWithinTheirRange) {
    std::set<std::string> keys;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        EXPECT_TRUE(keys.insert(field.key()).second) << field.name;
        EXPECT_LT(field.name.size(), 32u) << field.name << ": the wire's bound";
        EXPECT_LT(field.low, field.high) << field.name;
        EXPECT_GT(field.per_unit, 0.0f) << field.name;
        const float usual = RuntimeParameters{}.*field.value / field.per_unit;
        EXPECT_TRUE(usual >= field.low && usual <= field.high) << field.name;
        EXPECT_EQ(find_runtime_parameter(field.name), &field);
        EXPECT_FALSE(field.help.empty() || field.group.empty() || field.si.empty()) << field.name;
    }
    EXPECT_TRUE(keys.contains("head_elevation_deg"));
    EXPECT_TRUE(keys.contains("tissue_stiffness_kpa"));
    EXPECT_TRUE(keys.contains("tongue_scale"));
    EXPECT_EQ(find_runtime_parameter("head_elevation_deg"), nullptr);
}

/// A constant rate for an angle; for a stiffness a factor of e a second (closed form e^t, in steps of 1/180
/// s).
TEST(Followed, ConvergesAtItsRate) {
    const RuntimeParameters from;
    RuntimeParameters to = from;
    to.table_angle = 0.3f;
    to.tissue_stiffness = 100e3f;
    to.suction = 1.0f;
    RuntimeParameters now = from;
    for (int step = 0; step < 180; ++step) {
        now = advance_towards(now, to, 1.0f / 180.0f, 1.0f);
        EXPECT_EQ(now.suction, 1.0f) << "at once";
    }
    EXPECT_NEAR(now.table_angle, 0.17f, 1e-5f);
    EXPECT_NEAR(now.tissue_stiffness, 8e3f * std::exp(1.0f), 0.005f * 8e3f * std::exp(1.0f));
    for (int step = 0; step < 600; ++step) {
        now = advance_towards(now, to, 1.0f / 180.0f, 1.0f);
    }
    EXPECT_EQ(now, to);
    EXPECT_EQ(advance_towards(from, to, 1.0f / 180.0f, 1e6f), to) << "in great haste";
}

TEST(Clamped, LimitsOnlyValuesOutOfRange) {
    EXPECT_EQ(clamped(RuntimeParameters{}), RuntimeParameters{});
    RuntimeParameters beyond;
    beyond.head_elevation = 2.0f;
    beyond.tongue_scale = 0.1f;
    const RuntimeParameterField& head = *find_runtime_parameter("head_elevation");
    EXPECT_EQ(clamped(beyond).head_elevation, head.high * head.per_unit);
    EXPECT_EQ(clamped(beyond).tongue_scale, find_runtime_parameter("tongue_scale")->low);
}

}  // namespace
}  // namespace eti
