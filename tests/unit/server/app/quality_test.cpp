// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/quality.hpp"

#include <gtest/gtest.h>

#include "common/model/pace.hpp"
#include "common/scenario/data_file.hpp"

namespace eti::app {
namespace {

Scenario with(const std::string& physics) {
    return parse_scenario("name: a\nlaryngoscope:\n  blade: miller_1\n" + physics, "a.yaml");
}

TEST(ReducedQuality, HalvesSubsteps) {
    const Scenario full = with("physics:\n  substeps: 8\n  spacing_mm: 3\n");
    const Scenario less = reduced(full);
    EXPECT_EQ(less.physics.substeps, 4);
    EXPECT_FLOAT_EQ(less.physics.spacing, full.physics.spacing);
    EXPECT_EQ(less.name, full.name);
    EXPECT_EQ(reduced(with("physics:\n  substeps: 1\n")).physics.substeps, 1);
}

// A recording holds the scenario's text, from which it is simulated again.
TEST(ReducedQuality, TextGivesTheSameScenario) {
    const Scenario less = reduced(with(""));
    const Scenario again = parse_scenario(less.text, "b.yaml");
    EXPECT_EQ(again.physics.substeps, less.physics.substeps);
    EXPECT_EQ(again.name, "a");
}

TEST(RealTime, NeedsTimeForTheLift) {
    EXPECT_TRUE(keeps_real_time(0.5 * static_cast<double>(step_duration)));
    EXPECT_FALSE(keeps_real_time(0.7 * static_cast<double>(step_duration)));
}

}  // namespace
}  // namespace eti::app
