// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/unit/server/pbd/fluid/fluid_fixture.hpp"

namespace eti::pbd {
namespace {

using namespace fluid_fixture;

std::vector<FluidEmitter> glands() {
    std::vector<FluidEmitter> emitters(2);
    emitters[0].position = Vec3f(-20e-3f, 0, 0);
    emitters[0].flow = 1.3e-6f;
    emitters[1].position = Vec3f(20e-3f, 0, 0);
    emitters[1].direction = Vec3f(1, 0, 0);
    emitters[1].flow = 0.4e-6f;
    return emitters;
}

TEST(FluidEmitter, FlowMatchesSetting) {
    Fluid fluid(FluidSettings{}, 7);
    fluid.set_emitters(glands());
    constexpr int steps = 720;
    for (int n = 0; n < steps; ++n) {
        fluid.step(dt, Vec3f::Zero(), {});
    }
    int left = 0, right = 0;
    for (const Vec3f& x : fluid.positions()) {
        ++(x.x() < 0.0f ? left : right);
    }
    // Each emitter is behind by less than one particle, and they do not mix: each drop is 8 mm in radius at
    // most.
    const float seconds = steps * dt;
    EXPECT_NEAR(static_cast<float>(left), 1.3e-6f * seconds / fluid.particle_volume(), 1.0f);
    EXPECT_NEAR(static_cast<float>(right), 0.4e-6f * seconds / fluid.particle_volume(), 1.0f);
    EXPECT_EQ(fluid.left_domain(), 0u);
    EXPECT_EQ(fluid.overflow(), 0u);
}

TEST(FluidEmitter, SpeedAndDirectionAreUniformWithinBounds) {
    // One particle a step, observed before it meets the next.
    FluidEmitter emitter;
    emitter.direction = Vec3f(0, 1, 0);
    emitter.speed = 0.5f;
    emitter.speed_spread = 0.4f;
    emitter.cone = 0.3f;
    emitter.flow = 1.01e-9f / dt;
    Fluid fluid(plain(), 9);
    fluid.set_emitters({&emitter, 1});
    constexpr int samples = 400;
    float sum = 0.0f, lowest = 1.0f, highest = 0.0f, widest = 0.0f;
    FluidSuction everything;
    everything.strength = 1.0f;
    everything.radius = 0.05f;
    for (int n = 0; n < samples; ++n) {
        FluidSurroundings surroundings;
        fluid.step(dt, Vec3f::Zero(), surroundings);
        ASSERT_GE(fluid.count(), 1u);
        const Vec3f v = fluid.velocities()[0];
        sum += v.norm();
        lowest = std::min(lowest, v.norm());
        highest = std::max(highest, v.norm());
        widest = std::max(widest, std::acos(std::min(v.normalized().y(), 1.0f)));
        // Removes everything, including particles emitted in this step.
        surroundings.suctions = {&everything, 1};
        fluid.step(dt, Vec3f::Zero(), surroundings);
        ASSERT_EQ(fluid.count(), 0u);
    }
    // Uniform in 0.5 +- 0.2: the mean of 400 has a deviation of 0.2 / sqrt(3 * 400) = 0.006; three of them.
    EXPECT_NEAR(sum / samples, 0.5f, 0.018f);
    EXPECT_GE(lowest, 0.3f - 1e-5f);
    EXPECT_LE(highest, 0.7f + 1e-5f);
    EXPECT_GT(highest - lowest, 0.36f);
    // acos near 1 loses half the digits: 3e-4.
    EXPECT_LE(widest, 0.3f + 1e-3f);
    EXPECT_GT(widest, 0.28f);
}

TEST(FluidEmitter, IsReproducibleBySeed) {
    const auto run = [](Fluid& fluid) {
        for (int n = 0; n < 300; ++n) {
            fluid.step(dt, Vec3f(0, 0, -g), {});
        }
        return std::vector<Vec3f>(fluid.positions().begin(), fluid.positions().end());
    };
    const auto same = [](const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
    };
    Fluid fluid(FluidSettings{}, 11);
    fluid.set_emitters(glands());
    const auto first = run(fluid);
    ASSERT_GT(first.size(), 100u);
    fluid.reset(12);
    EXPECT_EQ(fluid.count(), 0u);
    EXPECT_FALSE(same(run(fluid), first));
    fluid.reset(11);
    EXPECT_TRUE(same(run(fluid), first));
    // Also after another step length: a reset discards pressures.
    fluid.step(0.3f * dt, Vec3f(0, 0, -g), {});
    fluid.reset(11);
    EXPECT_TRUE(same(run(fluid), first));
}

TEST(FluidSuction, RemovesOnlyParticlesWithinRadius) {
    Fluid fluid(plain());
    fill(fluid, 10, 10, 10);
    FluidSuction suction;
    suction.tip = spacing * Vec3f(5, 5, 10);
    suction.radius = 2.6e-3f;
    suction.reach = 0.0f;
    FluidSurroundings surroundings;
    surroundings.suctions = {&suction, 1};
    fluid.step(dt, Vec3f::Zero(), surroundings);
    EXPECT_EQ(fluid.count(), 1000u) << "strength 0";
    const auto before = by_id(fluid);
    suction.strength = 0.5f;
    std::size_t within = 0;
    for (const Vec3f& x : before) {
        within += (x - suction.tip).norm() < suction.radius;
    }
    ASSERT_GT(within, 20u);
    fluid.step(dt, Vec3f::Zero(), surroundings);
    EXPECT_EQ(fluid.count(), 1000u - within);
    EXPECT_EQ(fluid.aspirated(), within);
    for (const std::uint32_t id : fluid.ids()) {
        EXPECT_GE((before[id] - suction.tip).norm(), suction.radius);
    }
}

TEST(FluidSuction, InflowMatchesPointSink) {
    // Single particles beyond the radius: towards the tip at strength flow / (4 pi r^2), and not at all
    // beyond the reach. A position's rounding over the step of 10 us is 5e-5 m/s, some 1e-3 of the speed.
    FluidSuction suction;
    suction.strength = 0.7f;
    Fluid fluid(plain());
    fluid.add(Vec3f(5e-3f, 0, 0));
    fluid.add(Vec3f(0, 9e-3f, 0));
    FluidSurroundings surroundings;
    surroundings.suctions = {&suction, 1};
    fluid.step(1e-5f, Vec3f::Zero(), surroundings);
    ASSERT_EQ(fluid.count(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const float speed = 0.7f * suction.flow / (4.0f * 3.14159265f * 25e-6f);
        const Vec3f expected = fluid.ids()[i] == 0 ? Vec3f(-speed, 0, 0) : Vec3f::Zero();
        EXPECT_LT((fluid.velocities()[i] - expected).norm(), 5e-3f * speed);
    }
}

TEST(FluidSuction, EmptiesAPool) {
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(12, 12, 12));
    Fluid fluid{FluidSettings{}};
    fill(fluid, 12, 12, 4);
    FluidSuction suction;
    suction.strength = 1.0f;
    suction.tip = spacing * Vec3f(6, 6, 1);
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    surroundings.suctions = {&suction, 1};
    for (int n = 0; n < 1440; ++n) {
        fluid.step(dt, Vec3f(0, 0, -g), surroundings);
    }
    // A sink of 5 ml/s against 0.58 ml in a pool half as wide as its reach: a film remains.
    EXPECT_LT(fluid.count(), 576u / 4);
    EXPECT_EQ(fluid.count() + fluid.aspirated(), 576u);
}

TEST(FluidBounds, OverflowIsCountedAndHarmless) {
    FluidSettings settings = plain();
    settings.capacity = 100;
    Fluid fluid(settings);
    fluid.set_emitters(glands());
    for (int n = 0; n < 200; ++n) {
        fluid.step(dt, Vec3f::Zero(), {});
    }
    EXPECT_EQ(fluid.count(), 100u);
    const float emitted = 1.7e-6f * 200 * dt / fluid.particle_volume();
    EXPECT_NEAR(static_cast<float>(fluid.overflow()), emitted - 100.0f, 2.0f);
    EXPECT_FALSE(fluid.add(Vec3f::Zero()));
    fluid.reset(0);
    EXPECT_EQ(fluid.overflow(), 0u);
}

TEST(FluidBounds, CrowdedNeighboursAreCounted) {
    Fluid fluid(plain());
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        fluid.add(0.2f * spacing * Vec3f(random.normal(), random.normal(), random.normal()));
    }
    fluid.step(dt, Vec3f::Zero(), {});
    EXPECT_GT(fluid.dropped_neighbours(), 0u);
    EXPECT_EQ(fluid.count(), 200u);
}

TEST(FluidBounds, ParticlesThatLeaveTheDomainAreRemoved) {
    Fluid fluid(plain());
    fluid.add(Vec3f::Zero());
    fluid.add(Vec3f(0.0999f, 0, 0), Vec3f(1.0f, 0, 0));
    fluid.add(Vec3f(0, std::numeric_limits<float>::quiet_NaN(), 0));
    fluid.step(dt, Vec3f::Zero(), {});
    EXPECT_EQ(fluid.count(), 1u);
    EXPECT_EQ(fluid.left_domain(), 2u);
    EXPECT_EQ(fluid.ids()[0], 0u);
}

TEST(FluidBounds, ImpossibleDomainIsRefused) {
    FluidSettings settings;
    settings.upper = settings.lower;
    settings.upper.z() -= 0.1f;
    EXPECT_THROW(Fluid{settings}, std::invalid_argument);
    settings = FluidSettings{};
    settings.upper = Vec3f::Constant(10.0f);
    EXPECT_THROW(Fluid{settings}, std::invalid_argument);
}

}  // namespace
}  // namespace eti::pbd
