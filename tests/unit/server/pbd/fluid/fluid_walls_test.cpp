// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>

#include "common/math/random.hpp"
#include "tests/unit/server/pbd/fluid/fluid_fixture.hpp"

namespace eti::pbd {
namespace {

using namespace fluid_fixture;

TEST(FluidWalls, NothingLeaksFromAShakenVessel) {
    const RigidTransform pose =
        RigidTransform::from(Quatf(Eigen::AngleAxisf(0.7f, Vec3f(1, 1, 0).normalized())), Vec3f::Zero());
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(12, 10, 14), pose);
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    Fluid fluid{FluidSettings{}};
    fill(fluid, 12, 10, 8, pose);
    Random random(5);
    Vec3f gravity = Vec3f::Zero();
    for (int n = 0; n < 1440; ++n) {
        if (n % 120 == 0) {
            // Up to four times gravity, in any direction.
            gravity = 2.0f * g * Vec3f(random.normal(), random.normal(), random.normal());
        }
        fluid.step(dt, gravity, surroundings);
        for (const Vec3f& x : fluid.positions()) {
            // Spheres of half the spacing. In corners, three rounds of pushing along one nearest wall at a
            // time leave the last push's error against the others: a tenth of the spacing is allowed.
            ASSERT_GT(solid.distance(x), 0.4f * spacing) << n;
        }
    }
    EXPECT_EQ(fluid.count(), 960u);
}

TEST(FluidWalls, NothingEntersStirringBlade) {
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(30, 12, 20));
    Fluid fluid{FluidSettings{}};
    fill(fluid, 30, 12, 8);
    Vec3f at_before(15e-3f, 6e-3f, 19e-3f);
    for (int n = 1; n < 1440; ++n) {
        // Dips in and stirs at up to 0.4 m/s, three times the speed of the liquid's own waves.
        const float phase = 50.0f * static_cast<float>(n) * dt;
        const float depth = std::max(19e-3f - 0.05f * static_cast<float>(n) * dt, 5e-3f);
        const Vec3f now(15e-3f + 8e-3f * std::sin(phase), 6e-3f, depth);
        MovingCapsule capsule;
        capsule.radius = 2e-3f;
        const Vec3f up(0, 0, 0.05f);
        capsule.a_before = at_before;
        capsule.b_before = at_before + up;
        capsule.a = now;
        capsule.b = now + up;
        at_before = now;
        FluidSurroundings surroundings;
        surroundings.solid = &solid;
        surroundings.capsules = {&capsule, 1};
        fluid.step(dt, Vec3f(0, 0, -g), surroundings);
        for (const Vec3f& x : fluid.positions()) {
            const float t = closest_on_segment(capsule.a, capsule.b, x);
            const float gap = (x - capsule.a - t * (capsule.b - capsule.a)).norm() - capsule.radius;
            // The gap to the vessel is wider than a particle, so both limits can be met; rounds as above.
            ASSERT_GT(gap, 0.4f * spacing) << n;
            ASSERT_GT(solid.distance(x), 0.4f * spacing) << n;
        }
    }
    EXPECT_EQ(fluid.count(), 2880u);
}

/// Mean speed along x of a pool after 0.1 s, starting at 0.1 m/s.
float sliding(float wall_viscosity) {
    FluidSettings settings = plain();
    settings.wall_viscosity = wall_viscosity;
    // Open along x: the trough is longer than the distance travelled.
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(60, 10, 10));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    Fluid fluid(settings);
    for (int x = 10; x < 30; ++x) {
        for (int y = 0; y < 10; ++y) {
            for (int z = 0; z < 2; ++z) {
                fluid.add(spacing * (at(x, y, z) + Vec3f::Constant(0.5f)), Vec3f(0.1f, 0, 0));
            }
        }
    }
    for (int n = 0; n < 144; ++n) {
        fluid.step(dt, Vec3f(0, 0, -g), surroundings);
    }
    return static_cast<float>(mean_velocity(fluid).x());
}

TEST(FluidWalls, DragFollowsSetting) {
    // No drag: the pool keeps sliding. 2 %: it also spreads, and corners of the trough take a little.
    EXPECT_NEAR(sliding(0.0f), 0.1f, 0.002f);
    // With drag it loses speed, more with more drag; it never reverses.
    const float some = sliding(2e-6f), much = sliding(1e-3f);
    EXPECT_LT(some, 0.09f);
    EXPECT_GT(some, 0.03f);
    EXPECT_LT(much, 0.3f * some);
    EXPECT_GT(much, -0.001f);
}

TEST(FluidWalls, AdhesionHoldsAFilmAgainstGravity) {
    // A film two particles thick under a ceiling weighs 20 Pa; adhesion holds tension (1 + cos angle) over
    // a kernel's radius, 55 Pa for full wetting, and none at an angle of pi.
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(20, 20, 20));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    for (const bool wets : {true, false}) {
        FluidSettings settings;
        settings.contact_angle = wets ? 0.0f : 3.14159265f;
        Fluid fluid(settings);
        fill(fluid, 8, 8, 2, RigidTransform::from(Quatf::Identity(), spacing * at(6, 6, 18)));
        for (int n = 0; n < 288; ++n) {
            fluid.step(dt, Vec3f(0, 0, -g), surroundings);
        }
        int held = 0;
        for (const Vec3f& x : fluid.positions()) {
            held += x.z() > 15 * spacing;
        }
        EXPECT_EQ(held, wets ? 128 : 0);
    }
}

TEST(FluidWalls, ParticleFallsFreelyFromNonWettingWall) {
    // Walls without adhesion exert no pull: a lone particle at the ceiling falls freely. The first step may
    // only correct a density deficit, of which there is none: the tolerance is a step's own error, g t dt /
    // 2.
    FluidSettings settings = plain();
    settings.contact_angle = 3.14159265f;
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(20, 20, 20));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    Fluid fluid(settings);
    fluid.add(spacing * Vec3f(10, 10, 19.5f));
    constexpr int steps = 72;
    for (int n = 0; n < steps; ++n) {
        fluid.step(dt, Vec3f(0, 0, -g), surroundings);
    }
    const float time = steps * dt;
    EXPECT_NEAR(fluid.positions()[0].z(), 19.5f * spacing - 0.5f * g * time * time, 0.6f * g * time * dt);
}

TEST(FluidWalls, ResolvingOverlapAddsNoVelocity) {
    // A quarter of the spacing deep: pushed out within a step, that would be 0.36 m/s.
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(20, 20, 20));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    FluidSettings settings = plain();
    settings.contact_angle = 3.14159265f;
    Fluid fluid(settings);
    fluid.add(spacing * Vec3f(10, 10, 0.25f));
    fluid.step(dt, Vec3f::Zero(), surroundings);
    // A float's rounding of 0.01 m over dt.
    EXPECT_NEAR(fluid.positions()[0].z(), 0.5f * spacing, 1e-8f);
    EXPECT_LT(fluid.velocities()[0].norm(), 1e-5f);
}

}  // namespace
}  // namespace eti::pbd
