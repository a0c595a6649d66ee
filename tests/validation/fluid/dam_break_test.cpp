// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <iostream>

#include "tests/validation/fluid/dam_break.hpp"

namespace eti::test {
namespace {

// 16 x 32 x 6 = 3072 particles of 3.6 mm.
class DamBreakTest : public testing::TestWithParam<float> {};

TEST_P(DamBreakTest, FrontFollowsMartinAndMoyce) {
    const DamBreak result = dam_break(16, 6, GetParam(), 5);
    ASSERT_EQ(result.particles, 3072u);
    EXPECT_EQ(result.lost, 0u);
    const auto& experiment = martin_and_moyce;
    for (std::size_t k = 0; k < experiment.size(); ++k) {
        std::cout << "T " << experiment[k].time << "  Z measured " << experiment[k].front << ", here "
                  << result.fronts[k] << "\n";
    }
    const float rms = result.error();
    const float speed = (result.fronts[10] - result.fronts[2]) / (experiment[10].time - experiment[2].time);
    const float measured_speed =
        (experiment[10].front - experiment[2].front) / (experiment[10].time - experiment[2].time);
    std::cout << "front off by " << 100.0f * rms << " % rms, its speed by "
              << 100.0f * (speed / measured_speed - 1.0f) << " %\n";
    // The speed of the developed front does not depend on the start time: what remains is the digitisation's
    // few per cent, over a distance known to two such errors.
    EXPECT_NEAR(speed, measured_speed, 0.06f * measured_speed);
    // Positions do: here the gate vanishes at once and the floor is smooth, so the front may only lead.
    // Digitisation (4 %), the front's width of a particle (0.06 of Z = 1.2 to 10: 2 % in the mean), and a
    // gate that takes 10 ms to open (0.19 in T, 0.3 in Z, 8 % in the mean) add up to 14 %. As independent
    // errors they make 9 %. The bound lies between.
    EXPECT_LT(rms, 0.12f);
    EXPECT_GT(result.fronts[10], experiment[10].front * 0.96f);
}

INSTANTIATE_TEST_SUITE_P(Substeps, DamBreakTest, testing::Values(1.0f / 1440.0f, 1.0f / 2880.0f));

}  // namespace
}  // namespace eti::test
