// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/clock.hpp"

#include <gtest/gtest.h>

namespace eti::app {
namespace {

constexpr int steps = 100;
constexpr double period = 1e-3;  // [s]
constexpr double work = 2e-3;    // [s], of a step: twice what there is

/// Runs steps that take at least `work`. A busy machine makes them longer, never shorter.
double behind_after(StepClock& clock) {
    for (int i = 0; i < steps; ++i) {
        clock.wait();
        const auto until = StepClock::Time::now() + std::chrono::duration<double>(work);
        while (StepClock::Time::now() < until) {
        }
        clock.done();
    }
    return clock.behind();
}

TEST(StepClock, FallsBehindByWhatItsStepsTakeTooLong) {
    StepClock clock(period, true);
    EXPECT_GE(behind_after(clock), (steps - 1) * (work - period));
    EXPECT_GE(clock.late(), static_cast<std::uint32_t>(steps - 1));
}

TEST(StepClock, LeavesToOthersItsShare) {
    StepClock clock(period, true, 0.5);
    // But for the 20 ms that it may run ahead of what it owes.
    EXPECT_GE(behind_after(clock), (steps - 1) * (work - period + 0.5 * work) - 0.02);
}

TEST(StepClock, WithoutPaceNothingIsLate) {
    StepClock clock(period, false, 0.5);
    EXPECT_EQ(behind_after(clock), 0.0);
    EXPECT_EQ(clock.late(), 0u);
    EXPECT_GE(clock.percentile(0.5), 0.99 * work) << "kept in floats";
    clock.wait();
    clock.done();
    EXPECT_LT(clock.percentile(0.5, 1), 0.5 * work) << "of the last step, which did nothing";
    EXPECT_GE(clock.load(), 0.0);
}

}  // namespace
}  // namespace eti::app
