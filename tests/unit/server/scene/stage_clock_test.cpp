// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/stage_clock.hpp"

#include <gtest/gtest.h>

#include "server/scene/scene.hpp"
#include "tests/support/coarse_newborn.hpp"

namespace eti::scene {
namespace {

TEST(StageClock, BooksAWholeStepAndChangesNothing) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    Inputs inputs;
    inputs.laryngoscope.translation = Vec3f(0.0f, -0.25f, 0.15f);
    inputs.tube_grip.translation = Vec3f(-0.12f, -0.25f, 0.10f);
    Scene plain(test::coarse_newborn(), scope, Tube{}, inputs, {});
    Scene timed(test::coarse_newborn(), scope, Tube{}, inputs, {});
    StageClock clock;
    timed.time_stages(&clock);
    for (int k = 0; k < 5; ++k) {
        plain.step(inputs);
        const StageClock::Clock::time_point before = StageClock::Clock::now();
        timed.step(inputs);
        const std::chrono::duration<double, std::milli> wall = StageClock::Clock::now() - before;
        double sum = 0.0;
        for (int s = 0; s < static_cast<int>(Stage::count); ++s) {
            const auto stage = static_cast<Stage>(s);
            EXPECT_GT(clock.ms(stage), 0.0) << name_of(stage);
            sum += clock.ms(stage);
        }
        EXPECT_LE(sum, wall.count());
    }
    EXPECT_EQ(timed.state_hash(), plain.state_hash());
}

}  // namespace
}  // namespace eti::scene
