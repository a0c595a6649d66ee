// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/safety.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace eti::devices {
namespace {

constexpr float safety_dt = 1e-3f;
const SafetySettings settings;

TEST(Freshness, IsOneWhileHeldThenZeroBy300ms) {
    Freshness freshness(settings);
    EXPECT_EQ(freshness.share(), 0.0f);
    EXPECT_NEAR(settings.stale_after(), 0.1f, 1e-6f);
    for (int age_ms = 0; age_ms <= 400; ++age_ms) {
        const float age = 1e-3f * static_cast<float>(age_ms);
        const float wanted = age_ms <= 100 ? 1.0f : std::max(0.0f, (0.3f - age) / 0.2f);
        EXPECT_NEAR(freshness.update(age), wanted, 1e-5f) << age_ms;
    }
    EXPECT_EQ(freshness.update(0.3001f), 0.0f);
    EXPECT_EQ(freshness.update(0.005f), 1.0f) << "what comes back slowly is the force, not the share";
}

TEST(Freshness, SilenceLimitScalesHoldAndFade) {
    SafetySettings longer;
    longer.silence_limit = 0.6f;
    Freshness freshness(longer);
    EXPECT_EQ(freshness.update(0.199f), 1.0f);
    EXPECT_NEAR(freshness.update(0.4f), 0.5f, 1e-5f);
    EXPECT_EQ(freshness.update(0.601f), 0.0f);
}

TEST(Freshness, InvalidAgeIsStale) {
    for (const float age :
         {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Freshness freshness(settings);
        EXPECT_EQ(freshness.update(age), 0.0f);
    }
}

Wrench pushing(const Vec3f& force) {
    return {force, Vec3f::Zero()};
}

TEST(ForceRecoveryRamp, RestoresForceWithin300msAtLimitedRate) {
    const CouplingSettings coupling;
    ForceRecoveryRamp regrowth(settings);
    const Wrench wanted{{0, coupling.force_limit, 0}, {coupling.torque_limit, 0, 0}};
    constexpr float felt = 0.06f;  // [N]
    Wrench last;
    int cycles = 0;
    for (; wanted.force.norm() - last.force.norm() > felt && cycles < 1000; ++cycles) {
        EXPECT_EQ(regrowth.active(), cycles > 0) << cycles;
        // Messages keep reporting the gap for a while, without further effect.
        const Wrench now = regrowth.update(wanted, last, cycles < 80 && cycles % 5 == 0, safety_dt, coupling);
        EXPECT_LE((now.force - last.force).norm(),
                  1.01f * coupling.force_limit * safety_dt / settings.return_time);
        EXPECT_LE((now.torque - last.torque).norm(),
                  1.01f * coupling.torque_limit * safety_dt / settings.return_time);
        last = now;
    }
    EXPECT_NEAR(static_cast<float>(cycles) * safety_dt, settings.return_time, 3.0f * safety_dt);
    EXPECT_LT(settings.return_time, 0.3f);
    for (int i = 0; i < 3; ++i) {
        last = regrowth.update(wanted, last, false, safety_dt, coupling);
    }
    EXPECT_EQ(last.force, wanted.force);
    EXPECT_EQ(last.torque, wanted.torque);
    EXPECT_FALSE(regrowth.active());
}

TEST(ForceRecoveryRamp, ReductionIsImmediate) {
    const CouplingSettings coupling;
    ForceRecoveryRamp regrowth(settings);
    const Wrench had = pushing({4, 0, 0});
    EXPECT_EQ(regrowth.update(pushing({1, 0, 0}), had, true, safety_dt, coupling).force, Vec3f(1, 0, 0));
    EXPECT_FALSE(regrowth.active());
    EXPECT_EQ(regrowth.update(pushing({0, 0, 0}), had, true, safety_dt, coupling).force, Vec3f(0, 0, 0));
    // A change of the wanted force is new, also when opposed to the old one: it gets a cycle's share of the
    // ramp.
    const float share = coupling.force_limit * safety_dt / settings.return_time;
    EXPECT_LT((regrowth.update(pushing({1, 3, 0}), had, true, safety_dt, coupling).force - Vec3f(1, share, 0))
                  .norm(),
              1e-5f);
    EXPECT_NEAR(regrowth.update(pushing({-2, 0, 0}), had, true, safety_dt, coupling).force.x(), -share,
                1e-5f);
}

// While 3 N of 4 are still missing, the hand feels the full stiffness: a change of a newton in the wanted
// force is a change of a newton in the output, down to zero, where the recovery ends.
TEST(ForceRecoveryRamp, KeepsFullStiffnessAndNeverPulls) {
    const CouplingSettings coupling;
    ForceRecoveryRamp regrowth(settings);
    (void)regrowth.update(pushing({0, 4, 0}), pushing({0, 1, 0}), true, 0.0f, coupling);
    for (const auto& [wanted, felt] : {std::pair{4.0f, 1.0f}, {5.0f, 2.0f}, {3.5f, 0.5f}, {2.0f, 0.0f}}) {
        EXPECT_NEAR(regrowth.update(pushing({0, wanted, 0}), {}, false, 0.0f, coupling).force.y(), felt,
                    1e-6f);
    }
    EXPECT_EQ(regrowth.update(pushing({0, -1, 0}), {}, false, 0.0f, coupling).force.y(), -1.0f);
}

TEST(ForceRecoveryRamp, IsInactiveWithoutAGap) {
    const CouplingSettings coupling;
    ForceRecoveryRamp regrowth(settings);
    EXPECT_EQ(regrowth.update(pushing({0, 5, 0}), {}, false, safety_dt, coupling).force, Vec3f(0, 5, 0));
    (void)regrowth.update(pushing({0, 5, 0}), {}, true, safety_dt, coupling);
    regrowth.reset();
    EXPECT_EQ(regrowth.update(pushing({0, 5, 0}), {}, false, safety_dt, coupling).force, Vec3f(0, 5, 0));
}

TEST(Engagement, RequiresConsecutiveQuietCyclesThenRamps) {
    Engagement engagement(settings);
    for (int i = 0; i < settings.quiet_cycles - 1; ++i) {
        EXPECT_EQ(engagement.update(true, 0.1f, safety_dt), 0.0f);
    }
    EXPECT_EQ(engagement.update(true, 5.0f, safety_dt), 0.0f) << "one loud cycle starts the count anew";
    for (int i = 0; i < settings.quiet_cycles; ++i) {
        EXPECT_EQ(engagement.update(true, 0.1f, safety_dt), 0.0f);
    }
    int cycles = 0;
    float last = 0.0f;
    while (engagement.share() < 1.0f && cycles < 2000) {
        // Loud cycles no longer matter, and no cycle adds more than its share of the ramp.
        const float share = engagement.update(true, 5.0f, safety_dt);
        EXPECT_LE(share - last, safety_dt / settings.ramp_time + 1e-6f);
        last = share;
        ++cycles;
    }
    EXPECT_NEAR(static_cast<float>(cycles) * safety_dt, settings.ramp_time, 2.0f * safety_dt);
}

TEST(Engagement, DeviceStartingInContactGetsNoForce) {
    Engagement engagement(settings);
    for (int i = 0; i < 5000; ++i) {
        ASSERT_EQ(engagement.update(true, 3.0f, safety_dt), 0.0f);
    }
}

TEST(Engagement, RampsAfterOutageWithoutQuietCycles) {
    Engagement engagement(settings);
    for (int i = 0; i < 1000; ++i) {
        (void)engagement.update(true, 0.0f, safety_dt);
    }
    ASSERT_EQ(engagement.share(), 1.0f);
    EXPECT_EQ(engagement.update(false, 3.0f, safety_dt), 0.0f);
    for (int i = 0; i < settings.quiet_cycles; ++i) {
        EXPECT_EQ(engagement.update(true, 3.0f, safety_dt), 0.0f);
    }
    // By the faster recovery, so that the full force is back within 0.3 s of the outage.
    EXPECT_NEAR(engagement.update(true, 3.0f, safety_dt), safety_dt / settings.return_time, 1e-6f);
    EXPECT_LT(static_cast<float>(settings.quiet_cycles) * safety_dt + settings.return_time, 0.3f);
    engagement.disengage();
    for (int i = 0; i < 1000; ++i) {
        ASSERT_EQ(engagement.update(true, 3.0f, safety_dt), 0.0f)
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
        const Wrench next = rate_limited(wanted, last, safety_dt, coupling);
        EXPECT_LE((next.force - last.force).norm(), coupling.force_rate_limit * safety_dt * 1.0001f);
        EXPECT_LE(
            (next.torque - last.torque).norm(),
            coupling.force_rate_limit * safety_dt * coupling.torque_limit / coupling.force_limit * 1.0001f);
        last = next;
        ++cycles;
    }
    // 5 N at 600 N/s: 8.3 cycles.
    EXPECT_EQ(cycles, 9);
    EXPECT_EQ(rate_limited(wanted, wanted, safety_dt, coupling).force, wanted.force);
}

}  // namespace
}  // namespace eti::devices
