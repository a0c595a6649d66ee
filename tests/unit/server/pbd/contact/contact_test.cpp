// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/pbd/soft/links.hpp"

namespace eti::pbd {
namespace {

MovingCapsule still(float radius) {
    MovingCapsule c;
    c.b_before = c.b = Vec3f(0, 0, 0.05f);
    c.radius = radius;
    return c;
}

TEST(CapsuleContact, PushesToTheSurfaceAndNoFarther) {
    const MovingCapsule capsule = still(5e-3f);
    const Vec3f inside(3e-3f, 0, 0.02f);
    const Vec3f push = push_out_of(capsule, inside, inside, 1e-3f, 0.0f);
    EXPECT_NEAR((inside + push).x(), 6e-3f, 1e-8f);
    const Vec3f outside(7e-3f, 0, 0.02f);
    EXPECT_TRUE(push_out_of(capsule, outside, outside, 1e-3f, 0.0f).isZero());
}

TEST(CapsuleContact, FastCapsuleDoesNotPassAParticle) {
    // 1 m/s sideways over 1/720 s moves 1.4 mm; the sweep is tested at six times that.
    for (const float move : {1.4e-3f, 5e-3f, 9e-3f}) {
        MovingCapsule capsule = still(3e-3f);
        capsule.a_before.x() = capsule.b_before.x() = -4.1e-3f;
        capsule.a.x() = capsule.b.x() = -4.1e-3f + move;
        const Vec3f at(0, 0, 0.02f);
        const Vec3f moved = at + push_out_of(capsule, at, at, 1e-3f, 0.0f);
        if (-4.1e-3f + move + 4e-3f > 0.0f) {
            EXPECT_NEAR(moved.x(), -4.1e-3f + move + 4e-3f, 1e-7f) << move;
        }
    }
}

TEST(CapsuleContact, FirstContactIsWherePathMeetsCapsule) {
    // Closed forms: a cylinder hit from the side, its round end hit along the axis and beside it, and a miss.
    const Vec3f a = Vec3f::Zero(), b(0, 0, 0.05f);
    const float reach = 5e-3f;
    const auto met = [&](const Vec3f& from, const Vec3f& to) { return first_contact(a, b, reach, from, to); };
    const auto across = met({-0.02f, 3e-3f, 0.02f}, {0.03f, 3e-3f, 0.02f});
    ASSERT_TRUE(across.has_value());
    EXPECT_LT((*across - Vec3f(-4e-3f, 3e-3f, 0.02f)).norm(), 2e-7f);
    const auto tip = met({0, 0, 0.09f}, {0, 0, 0.01f});
    ASSERT_TRUE(tip.has_value());
    EXPECT_LT((*tip - Vec3f(0, 0, 0.055f)).norm(), 2e-7f);
    const auto beside = met({3e-3f, 0, 0.09f}, {3e-3f, 0, 0.01f});
    ASSERT_TRUE(beside.has_value());
    EXPECT_LT((*beside - Vec3f(3e-3f, 0, 0.054f)).norm(), 2e-7f);
    EXPECT_FALSE(met({5.1e-3f, 0, 0.09f}, {5.1e-3f, 0, 0.01f}).has_value());
    EXPECT_FALSE(met({0, 0, 0.09f}, {0, 0, 0.056f}).has_value());
    // Overlapping from the start: measured from the surface.
    const auto inside = met({4e-3f, 0, 0.02f}, {-4e-3f, 0, 0.02f});
    ASSERT_TRUE(inside.has_value());
    EXPECT_LT((*inside - Vec3f(5e-3f, 0, 0.02f)).norm(), 1e-8f);
}

TEST(CapsuleContact, FastTipCarriesParticleSlowTipDeflectsIt) {
    // A particle 1 mm off the axis of a round tip that advances. At low speed it is pushed outwards along the
    // sphere's normal; at 1 m/s and 1/1440 s it is carried ahead of the tip.
    for (const float move : {0.02e-3f, 0.7e-3f}) {
        MovingCapsule capsule = still(3e-3f);
        Vec3f at(1e-3f, 0, 0.0f);
        at.z() = capsule.b.z() + std::sqrt(16e-6f - 1e-6f);  // touching: reach is 4 mm
        for (int n = 0; n < 10; ++n) {
            capsule.a_before = capsule.a;
            capsule.b_before = capsule.b;
            capsule.a.z() += move;
            capsule.b.z() += move;
            at += push_out_of(capsule, at, at, 1e-3f, 0.0f);
            EXPECT_NEAR((at - capsule.b).norm(), 4e-3f, 1e-6f);
        }
        if (move > 4e-3f / 32.0f) {
            EXPECT_NEAR(at.x(), 1e-3f, 1e-6f);
        } else {
            // Pushed along (1, 0, sqrt 15) / 4: each step moves it outwards by 1/16 of the travel over sqrt
            // 15.
            EXPECT_GT(at.x(), 1e-3f + 10.0f * 0.9f * move / 4.0f * std::sqrt(15.0f) / 4.0f);
        }
    }
}

TEST(CapsuleContact, CoulombThresholdHoldsInAnyDirection) {
    // Closed form: penetration d and tangential slip t; held when t <= mu d, else shortened by mu d.
    const MovingCapsule capsule = still(5e-3f);
    const float mu = 0.5f;
    const float depth = 1e-4f;
    const Vec3f surface(5e-3f, 0, 0.02f);
    for (const float slip : {2e-5f, 4.9e-5f, 1e-4f}) {
        for (const float direction : {1.0f, -1.0f}) {
            const Vec3f before = surface;
            const Vec3f predicted = surface + Vec3f(-depth, 0, direction * slip);
            const Vec3f after = predicted + push_out_of(capsule, before, predicted, 0.0f, mu);
            const float left = std::max(slip - mu * depth, 0.0f);
            EXPECT_NEAR((after - before).z(), direction * left, 2e-8f);
        }
    }
}

TEST(Links, StaticStretchUnderLoadFollowsHooke) {
    // A particle of mass m hangs on a link of stiffness k: final stretch m g / k.
    const float mass = 1e-4f, stiffness = 20.0f, dt = 1.0f / 1440.0f;
    Vec3f top = Vec3f::Zero(), end(0, 0, -0.01f), velocity = Vec3f::Zero();
    for (int n = 0; n < 20000; ++n) {
        const Vec3f before = end;
        velocity.z() -= 9.81f * dt;
        velocity *= 0.99f;
        end += dt * velocity;
        project_link(top, end, 0.0f, 1.0f / mass, 0.01f, stiffness, dt);
        velocity = (end - before) / dt;
    }
    // Rounding of 0.01 m is 1e-9 m against a stretch of 4.9e-5 m; damping does not change the equilibrium.
    EXPECT_NEAR(-0.01f - end.z(), mass * 9.81f / stiffness, 0.02f * mass * 9.81f / stiffness);
    EXPECT_TRUE(top.isZero());
}

}  // namespace
}  // namespace eti::pbd
