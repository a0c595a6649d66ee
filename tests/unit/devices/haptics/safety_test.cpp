// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/safety.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace eti::devices {
namespace {

constexpr float dt = 1e-3f;
const SafetySettings settings;

TEST(Freshness, FallsToNothingWithin20msOfTheLastMessage) {
    Freshness freshness(settings);
    EXPECT_EQ(freshness.share(), 0.0f);
    EXPECT_EQ(freshness.update(0.0f, dt), 1.0f);
    int cycles = 0;
    for (float age = 0.0f; freshness.share() > 0.0f; age += dt, ++cycles) {
        const float share = freshness.update(age, dt);
        if (age <= settings.stale_after() - dt) {
            EXPECT_EQ(share, 1.0f) << age;
        }
        ASSERT_LT(cycles, 100);
    }
    // The cycle at 20 ms gives nothing, to float rounding of the sum of ages.
    EXPECT_GE(cycles, 20);
    EXPECT_LE(cycles, 21);
}

TEST(Freshness, TwoMessagesInARowMayBeLostAtNoCost) {
    Freshness freshness(settings);
    (void)freshness.update(0.0f, dt);
    EXPECT_EQ(freshness.update(3.0f / 180.0f, dt), 1.0f);
}

TEST(Freshness, WhatAGapTookComesBackSlowlyAfterAWhileWithoutAny) {
    Freshness freshness(settings);
    (void)freshness.update(0.0f, dt);
    const float lowest = freshness.update(0.0185f, dt);
    EXPECT_NEAR(lowest, 0.5f, 1e-5f) << "half of the fade from 17 to 20 ms";
    const int wait = static_cast<int>(settings.recovery_wait / dt);
    for (int i = 0; i < wait; ++i) {
        ASSERT_EQ(freshness.update(0.005f, dt), lowest) << i;
    }
    // A cycle more or less by the rounding of the waited time.
    int cycles = 0;
    for (float last = lowest; freshness.share() < 1.0f && cycles < 5000; ++cycles) {
        const float share = freshness.update(0.005f, dt);
        EXPECT_LE(share - last, dt / settings.recovery_time + 1e-6f);
        last = share;
    }
    EXPECT_NEAR(static_cast<float>(cycles) * dt, 0.5f * settings.recovery_time, 3.0f * dt);
}

TEST(Freshness, GapsThatRepeatThemselvesSettleAtWhatTheLongestLeft) {
    Freshness freshness(settings);
    (void)freshness.update(0.0f, dt);
    float least = 1.0f;
    for (int gap = 0; gap < 50; ++gap) {
        const float longest = gap % 7 == 0 ? 0.019f : 0.018f;
        for (float age = 0.0f; age < longest - 0.5f * dt; age += dt) {
            const float share = freshness.update(age, dt);
            ASSERT_LE(share, least) << gap;
            least = share;
        }
        least = freshness.update(longest, dt);
    }
    EXPECT_NEAR(least, 1.0f / 3.0f, 1e-4f);
}

TEST(Freshness, NonsenseIsStale) {
    for (const float age :
         {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Freshness freshness(settings);
        EXPECT_EQ(freshness.update(age, dt), 0.0f);
    }
}

TEST(Engagement, NeedsQuietCyclesInARowThenRampsOverItsTime) {
    Engagement engagement(settings);
    for (int i = 0; i < settings.quiet_cycles - 1; ++i) {
        EXPECT_EQ(engagement.update(true, 0.1f, dt), 0.0f);
    }
    EXPECT_EQ(engagement.update(true, 5.0f, dt), 0.0f) << "one loud cycle starts the count anew";
    for (int i = 0; i < settings.quiet_cycles; ++i) {
        EXPECT_EQ(engagement.update(true, 0.1f, dt), 0.0f);
    }
    int cycles = 0;
    float last = 0.0f;
    while (engagement.share() < 1.0f && cycles < 2000) {
        // Loud cycles no longer matter, and no cycle gives more than its part of the ramp.
        const float share = engagement.update(true, 5.0f, dt);
        EXPECT_LE(share - last, dt / settings.ramp_time + 1e-6f);
        last = share;
        ++cycles;
    }
    EXPECT_NEAR(static_cast<float>(cycles) * dt, settings.ramp_time, 2.0f * dt);
}

TEST(Engagement, ADeviceThatWakesUpInsideSomethingGetsNoForce) {
    Engagement engagement(settings);
    for (int i = 0; i < 5000; ++i) {
        ASSERT_EQ(engagement.update(true, 3.0f, dt), 0.0f);
    }
}

TEST(Engagement, AfterAnOutageItRampsAgainWithoutAskingForQuiet) {
    Engagement engagement(settings);
    for (int i = 0; i < 1000; ++i) {
        (void)engagement.update(true, 0.0f, dt);
    }
    ASSERT_EQ(engagement.share(), 1.0f);
    EXPECT_EQ(engagement.update(false, 3.0f, dt), 0.0f);
    for (int i = 0; i < settings.quiet_cycles; ++i) {
        EXPECT_EQ(engagement.update(true, 3.0f, dt), 0.0f);
    }
    EXPECT_NEAR(engagement.update(true, 3.0f, dt), dt / settings.ramp_time, 1e-6f);
    engagement.disengage();
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(engagement.update(true, 3.0f, dt), 0.0f)
            << "after a force that was not finite, quiet is asked for";
    }
}

TEST(RateLimited, MovesAtMostTheRateInAnyDirection) {
    const CouplingSettings coupling;
    Wrench wanted;
    wanted.force = {3.0f, -4.0f, 0.0f};
    wanted.torque = {0.0f, 0.0f, 0.2f};
    Wrench last;
    int cycles = 0;
    while ((wanted.force - last.force).norm() > 0.0f && cycles < 1000) {
        const Wrench next = rate_limited(wanted, last, dt, coupling);
        EXPECT_LE((next.force - last.force).norm(), coupling.force_rate_limit * dt * 1.0001f);
        EXPECT_LE((next.torque - last.torque).norm(),
                  coupling.force_rate_limit * dt * coupling.torque_limit / coupling.force_limit * 1.0001f);
        last = next;
        ++cycles;
    }
    // 5 N at 600 N/s: 8.3 cycles.
    EXPECT_EQ(cycles, 9);
    EXPECT_EQ(rate_limited(wanted, wanted, dt, coupling).force, wanted.force);
}

}  // namespace
}  // namespace eti::devices
