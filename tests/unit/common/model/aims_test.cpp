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

AimStatus light(std::string_view key, const AttemptMetrics& values,
                const AttemptMetrics& first = initial_metrics()) {
    return aim_status(shortfall(aim(key), values, first));
}

TEST(Aims, EachHasAMetricWithItsSource) {
    for (const Aim& one : aims) {
        const auto field = std::ranges::find(metric_fields, one.key, &MetricField::key);
        ASSERT_NE(field, metric_fields.end()) << one.key;
        EXPECT_FALSE(field->norm.empty()) << one.key;
        EXPECT_LE(one.reached, one.near) << one.key;
    }
}

// And conversely: no metric has an aim in words that no indicator shows.
TEST(Aims, EveryNormHasAnAim) {
    for (const MetricField& field : metric_fields) {
        EXPECT_EQ(field.norm.empty(), std::ranges::find(aims, field.key, &Aim::key) == aims.end())
            << field.key;
    }
}

TEST(Aims, ValueAtItsLimitIsReached) {
    AttemptMetrics p = initial_metrics();
    p.time_s = 30;
    EXPECT_EQ(light("time_s", p), AimStatus::reached);
    p.time_s = 30.1;
    EXPECT_EQ(light("time_s", p), AimStatus::near);
    p.time_s = 45.1;
    EXPECT_EQ(light("time_s", p), AimStatus::missed);
    p.oesophageal_entries = 1;
    EXPECT_EQ(light("oesophageal_entries", p), AimStatus::missed);
}

TEST(Aims, TubeDepthIsJudgedOnBothSidesOfTheRule) {
    AttemptMetrics p = initial_metrics();
    p.tube_depth_rule_cm = 9.5;
    for (const double depth : {9.1, 9.9}) {
        p.tube_depth_at_lip_cm = depth;
        EXPECT_EQ(light("tube_depth_at_lip_cm", p), AimStatus::reached) << depth;
    }
    for (const double depth : {8.4, 10.6}) {
        p.tube_depth_at_lip_cm = depth;
        EXPECT_EQ(light("tube_depth_at_lip_cm", p), AimStatus::missed) << depth;
    }
}

// Herrick et al. 2020: a fall by 20 points, from the session's initial value.
TEST(Aims, SaturationIsRelativeToItsInitialValue) {
    AttemptMetrics first = initial_metrics(), p = first;
    first.oxygen_saturation_end_percent = 90;
    p.oxygen_saturation_min_percent = 85;
    EXPECT_EQ(light("oxygen_saturation_percent.min", p, first), AimStatus::reached);
    p.oxygen_saturation_min_percent = 69;
    EXPECT_EQ(light("oxygen_saturation_percent.min", p, first), AimStatus::missed);
}

TEST(Aims, MissingValueIsUnknown) {
    AttemptMetrics p;
    for (const MetricField& field : metric_fields) {
        p.*field.value = nan;
    }
    for (const Aim& one : aims) {
        EXPECT_EQ(aim_status(shortfall(one, p, p)), AimStatus::unknown) << one.key;
    }
}

TEST(Aims, ForceWithoutPublishedLimitIsNeverMissed) {
    AttemptMetrics p = initial_metrics();
    p.gum_force_max_n = 1000;
    EXPECT_EQ(light("gum_force_n.max", p), AimStatus::near);
    p.gum_force_max_n = 5.3;
    EXPECT_EQ(light("gum_force_n.max", p), AimStatus::reached);
}

}  // namespace
}  // namespace eti
