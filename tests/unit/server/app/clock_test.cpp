// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/clock.hpp"

#include <gtest/gtest.h>

namespace eti::app {
namespace {

constexpr int steps = 100;
constexpr double period = 1e-3;  // [s]
constexpr double work = 2e-3;    // [s] per step: twice the time available

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

TEST(StepClock, LagEqualsAccumulatedOverrun) {
    StepClock clock(period, true);
    EXPECT_GE(behind_after(clock), (steps - 1) * (work - period));
    EXPECT_GE(clock.late_steps(), static_cast<std::uint32_t>(steps - 1));
}

TEST(StepClock, ReservesIdleShare) {
    StepClock clock(period, true, 0.5);
    // Except for the 20 ms that it may run ahead.
    EXPECT_GE(behind_after(clock), (steps - 1) * (work - period + 0.5 * work) - 0.02);
}

TEST(StepClock, UnpacedClockIsNeverLate) {
    StepClock clock(period, false, 0.5);
    EXPECT_EQ(behind_after(clock), 0.0);
    EXPECT_EQ(clock.late_steps(), 0u);
    EXPECT_GE(clock.percentile(0.5), 0.99 * work) << "kept in floats";
    clock.wait();
    clock.done();
    EXPECT_LT(clock.percentile(0.5, 1), 0.5 * work) << "of the last step, which did nothing";
    EXPECT_GE(clock.load(), 0.0);
}

}  // namespace
}  // namespace eti::app
