// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/threads.hpp"
#include "tests/unit/server/pbd/fluid/fluid_fixture.hpp"

namespace eti::pbd {
namespace {

using namespace fluid_fixture;

/// A shallow pool in a vessel, and events that wake it.
struct Pool {
    Pool() : solid(vessel(Vec3f::Zero(), spacing * at(10, 10, 12))) { fill(fluid, 10, 10, 4); }
    void step(int substeps) {
        FluidSurroundings surroundings;
        surroundings.solid = &solid;
        surroundings.capsules = capsules;
        surroundings.suctions = suctions;
        for (int n = 0; n < substeps; ++n) {
            fluid.step(dt, gravity, surroundings);
        }
    }
    [[nodiscard]] std::size_t awake() const { return fluid.count() - fluid.sleeping_count(); }

    Fluid fluid{FluidSettings{}};
    DistanceGrid solid;
    std::vector<MovingCapsule> capsules;
    std::vector<FluidSuction> suctions;
    Vec3f gravity{0, 0, -g};
};

constexpr int settled = 2160;  // substeps, 1.5 s

/// The pool, asleep.
Pool asleep() {
    Pool pool;
    pool.step(settled);
    return pool;
}

TEST(FluidRest, PoolFallsAsleepInPlace) {
    Pool pool = asleep();
    ASSERT_EQ(pool.awake(), 0u);
    const std::vector<Vec3f> before = by_id(pool.fluid);
    pool.step(100);
    EXPECT_EQ(by_id(pool.fluid), before);
    EXPECT_EQ(agitation(pool.fluid), 0.0);
    // The pool is as high as one with sleeping disabled: within the 1 % by which a moving one fluctuates.
    Pool restless;
    FluidSettings settings;
    settings.rest_time = 0.0f;
    restless.fluid = Fluid(settings);
    fill(restless.fluid, 10, 10, 4);
    restless.step(settled);
    EXPECT_EQ(restless.fluid.sleeping_count(), 0u);
    EXPECT_NEAR(centre(pool.fluid).z(), centre(restless.fluid).z(), 0.02f * spacing * 4);
}

TEST(FluidRest, MovedWallWakesOnlyNearbyParticles) {
    Pool pool = asleep();
    {
        DistanceGrid* const grid = &pool.solid;
        for (int z = 0; z < grid->size[2]; ++z) {
            for (int y = 0; y < grid->size[1]; ++y) {
                for (int x = 0; x < grid->size[0]; ++x) {
                    // The wall at x = 0 recedes by a fifth of a spacing.
                    const Vec3f p = grid->node(x, y, z);
                    float& value = grid->value[grid->index(x, y, z)];
                    if (p.x() < 2 * spacing && value > p.x() - 0.1e-3f && value < p.x() + 0.1e-3f) {
                        value += 0.2f * spacing;
                    }
                }
            }
        }
    }
    pool.step(1);
    EXPECT_GT(pool.awake(), 20u);
    EXPECT_LT(pool.awake(), 300u) << "the far side has not heard of it";
}

TEST(FluidRest, OnlyMovingToolWakesParticles) {
    Pool pool = asleep();
    MovingCapsule tool;
    tool.radius = 2e-3f;
    tool.a = tool.a_before = spacing * at(2, 5, 9);
    tool.b = tool.b_before = spacing * at(2, 5, 20);
    pool.capsules = {tool};
    pool.step(1);
    EXPECT_EQ(pool.awake(), 0u) << "3 mm above the surface";
    for (int n = 0; n < 144; ++n) {  // down by 3 mm
        tool.a_before = tool.a;
        tool.a.z() -= 3e-3f / 144.0f;
        pool.capsules = {tool};
        pool.step(1);
    }
    EXPECT_GT(pool.awake(), 10u);
    tool.a_before = tool.a;
    pool.capsules = {tool};
    pool.step(2 * settled);
    EXPECT_EQ(pool.awake(), 0u);
}

TEST(FluidRest, TurningGravityWakesAllParticles) {
    Pool pool = asleep();
    pool.gravity = g * Vec3f(0.002f, 0, -1);  // a ninth of a degree: below what a pool's slope shows
    pool.step(1);
    EXPECT_EQ(pool.awake(), 0u);
    pool.gravity = g * Vec3f(0.02f, 0, -1);
    pool.step(1);
    EXPECT_EQ(pool.awake(), pool.fluid.count());
}

TEST(FluidRest, FallingDropWakesParticlesBelow) {
    Pool pool = asleep();
    pool.fluid.add(spacing * Vec3f(5, 5, 8));
    int woken = 0;
    for (int n = 0; n < 200; ++n) {
        pool.step(1);
        woken = std::max(woken, static_cast<int>(pool.awake()));
    }
    EXPECT_GT(woken, 10);
    EXPECT_LT(woken, 400);
}

TEST(FluidRest, SuctionWakesParticlesInReach) {
    Pool pool = asleep();
    FluidSuction suction;
    suction.strength = 1.0f;
    suction.tip = spacing * Vec3f(5, 5, 4);
    suction.radius = 1.5e-3f;
    suction.reach = 4e-3f;
    pool.suctions = {suction};
    pool.step(30);
    EXPECT_GT(pool.fluid.aspirated(), 5u);
    EXPECT_GT(pool.awake(), 30u);
}

TEST(FluidRest, SameBitsForAnyThreadsAndInstructionSet) {
    const auto run = [](std::size_t threads, bool avx2) {
        Pool pool;
        pool.fluid.use_avx2(avx2 && has_avx2());
        eti::test::with_threads(threads, [&] {
            pool.step(900);
            pool.fluid.add(spacing * Vec3f(5, 5, 8));
            pool.step(300);
        });
        EXPECT_GT(pool.fluid.sleeping_count(), 0u);
        EXPECT_GT(pool.awake(), 0u);
        return by_id(pool.fluid);
    };
    const std::vector<Vec3f> first = run(1, true);
    EXPECT_EQ(run(8, true), first);
    EXPECT_EQ(run(2, false), first);
}

}  // namespace
}  // namespace eti::pbd
