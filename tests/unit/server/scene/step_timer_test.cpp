// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/step_timer.hpp"

#include <gtest/gtest.h>

#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"

namespace eti::scene {
namespace {

TEST(StepTimer, TimesEveryStageWithoutChangingState) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    const Inputs inputs = test::parked_tools(0.0f, 0.0f);
    Scene plain(test::coarse_newborn(), scope, Tube{}, inputs, {});
    Scene timed(test::coarse_newborn(), scope, Tube{}, inputs, {});
    StepTimer clock;
    timed.set_step_timer(&clock);
    for (int k = 0; k < 5; ++k) {
        plain.step(inputs);
        const StepTimer::Clock::time_point before = StepTimer::Clock::now();
        timed.step(inputs);
        const std::chrono::duration<double, std::milli> wall = StepTimer::Clock::now() - before;
        double sum = 0.0;
        for (int s = 0; s < static_cast<int>(StepStage::count); ++s) {
            const auto stage = static_cast<StepStage>(s);
            EXPECT_GT(clock.ms(stage), 0.0) << name_of(stage);
            sum += clock.ms(stage);
        }
        EXPECT_LE(sum, wall.count());
    }
    EXPECT_EQ(timed.state_hash(), plain.state_hash());
}

}  // namespace
}  // namespace eti::scene
