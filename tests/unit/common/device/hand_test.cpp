// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/math/random.hpp"

namespace eti {
namespace {

constexpr double pi = 3.14159265358979;

RigidTransform at(float x, float turn = 0.0f) {
    return {quaternion_from(Vec3f(0, 0, turn)), Vec3f(x, 0, 0)};
}

HandSettings frictionless() {
    HandSettings settings;
    settings.friction = 0.0f;
    return settings;
}

void settle(HandDevice& hand, const RigidTransform& wanted, const Wrench& wrench, double seconds = 2.0) {
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
        hand.step(wanted, wrench, 1e-3f);
    }
}

TEST(Hand, DeflectsByHookesLaw) {
    HandDevice hand(frictionless(), at(0));
    const Wrench wrench{Vec3f(0, 1.8f, 0), Vec3f(0, 0.2f, 0)};
    settle(hand, at(0), wrench);
    // Settled: damping is past 100 time constants; single precision stops a step when dt * v drops below
    // half a unit in the last place of x, here 1e-10 m and 1e-9 rad, far below the tolerances.
    EXPECT_NEAR(hand.motion().pose.translation.y(), 1.8f / 900.0f, 1e-7f);
    EXPECT_NEAR(rotation_vector(hand.motion().pose.rotation).y(), 0.2f / 4.0f, 1e-6f);
}

TEST(Hand, RestsWithinTheFrictionBand) {
    const HandSettings settings;
    HandDevice hand(settings, at(0));
    settle(hand, at(0.01f), {});
    const float band = settings.friction / settings.hand_stiffness;
    EXPECT_NEAR(hand.motion().pose.translation.x(), 0.01f, band * 1.001f);
    EXPECT_EQ(hand.motion().velocity.norm(), 0.0f);
}

TEST(Hand, ForceBelowFrictionMovesNothing) {
    const HandSettings settings;
    HandDevice hand(settings, at(0));
    settle(hand, at(0), {Vec3f(0.99f * settings.friction, 0, 0), Vec3f::Zero()});
    EXPECT_EQ(hand.motion().pose.translation.x(), 0.0f);
    settle(hand, at(0), {Vec3f(1.1f * settings.friction, 0, 0), Vec3f::Zero()});
    EXPECT_GT(hand.motion().pose.translation.x(), 0.0f);
}

class HandStep : public testing::TestWithParam<float> {};

TEST_P(HandStep, FreeOscillationMatchesTheory) {
    HandSettings settings = frictionless();
    settings.hand_damping = settings.device_damping = 0.0f;
    settings.hand_rotational_damping = settings.device_rotational_damping = 0.0f;
    const float dt = GetParam();
    HandDevice hand(settings, at(0.01f));
    std::vector<double> crossings;
    double before = 0.01;
    double time = 0;
    double peak_first = 0, peak_last = 0;
    while (crossings.size() < 9) {
        hand.step(at(0), {}, dt);
        time += static_cast<double>(dt);
        const double now = static_cast<double>(hand.motion().pose.translation.x());
        if (before * now < 0) {
            crossings.push_back(time - static_cast<double>(dt) * now / (now - before));
        }
        // Energy amplitude: sqrt(x^2 + (v/w)^2).
        const double w2 = static_cast<double>(settings.hand_stiffness / settings.mass);
        const double v = static_cast<double>(hand.motion().velocity.x());
        const double amplitude = std::sqrt(now * now + v * v / w2);
        peak_first = crossings.size() == 1 && peak_first == 0 ? amplitude : peak_first;
        peak_last = amplitude;
        before = now;
        ASSERT_LT(time, 5.0);
    }
    const double w = std::sqrt(static_cast<double>(settings.hand_stiffness / settings.mass));
    const double step = w * static_cast<double>(dt);
    const double measured = pi * 8 / (crossings.back() - crossings.front());
    // Backward Euler's roots are 1 / (1 +- i w dt): the frequency is atan(w dt)/dt = w (1 - (w dt)^2/3 +
    // ...), and the amplitude shrinks by (1 + (w dt)^2)^-1/2 per step. Linear interpolation of a crossing
    // errs by (w dt)^2/8 of a step at most; two of them over four periods: (w dt)^3 / (32 pi).
    EXPECT_NEAR(measured / w, 1.0, step * step / 3 + step * step * step / 100 + 1e-5);
    EXPECT_NEAR(measured * static_cast<double>(dt), std::atan(step),
                step * (step * step * step / 100 + 1e-5));
    const double steps = (crossings.back() - crossings.front()) / static_cast<double>(dt);
    EXPECT_NEAR(std::log(peak_last / peak_first), -0.5 * steps * std::log1p(step * step),
                std::log1p(step * step) + 1e-3);  // one step more or less, and rounding
}

TEST_P(HandStep, EnergyNeverGrowsWhileTheTargetRests) {
    const HandSettings settings;
    const float dt = GetParam();
    Random random(7);
    const RigidTransform wanted = at(0.02f, 0.3f);
    HandDevice hand(settings, at(0.02f, 0.3f));
    const auto vector = [&](float size) {
        return Vec3f(size * random.normal(), size * random.normal(), size * random.normal());
    };
    const auto energy = [&] {
        const Motion& m = hand.motion();
        const double stretch = (wanted.translation - m.pose.translation).cast<double>().squaredNorm();
        const double turn =
            rotation_vector(wanted.rotation * m.pose.rotation.conjugate()).cast<double>().squaredNorm();
        return 0.5 *
               (static_cast<double>(settings.mass) * m.velocity.cast<double>().squaredNorm() +
                static_cast<double>(settings.hand_stiffness) * stretch +
                static_cast<double>(settings.inertia) * m.angular_velocity.cast<double>().squaredNorm() +
                static_cast<double>(settings.hand_rotational_stiffness) * turn);
    };
    for (int kick = 0; kick < 20; ++kick) {
        for (int i = 0; i < 10; ++i) {
            hand.step(wanted, {vector(5), vector(0.1f)}, dt);
        }
        double before = energy();
        for (int i = 0; i < 200; ++i) {
            hand.step(wanted, {}, dt);
            const double now = energy();
            // Single precision: positions of 0.02 m carry 2e-9 m, which springs turn into k x dx, below 1e-7
            // J at a stretch of 20 mm; likewise 1e-7 rad for a rotation.
            ASSERT_LE(now, before * (1 + 1e-6) + 1e-9) << "kick " << kick << ", step " << i;
            before = now;
        }
    }
}

TEST_P(HandStep, PressedAgainstASpringWallRestsInBalance) {
    const HandSettings settings;
    const CouplingSettings coupling;
    const float depth = 0.004f;
    HandDevice hand(settings, at(-0.01f));
    // The wall holds the proxy at x = 0; the hand's goal is `depth` behind it. The wall only pushes.
    const auto push = [&] {
        Motion proxy;
        proxy.pose = at(0);
        Wrench wrench = coupling_wrench(hand.motion(), proxy, coupling);
        wrench.force.x() = std::min(wrench.force.x(), 0.0f);
        return hand.motion().pose.translation.x() > 0 ? clamp_to_limits(wrench, coupling) : Wrench{};
    };
    float contact_speed = 0;
    for (int i = 0; i < static_cast<int>(3.0f / GetParam()); ++i) {
        hand.step(at(depth), push(), GetParam());
        contact_speed = hand.motion().velocity.norm();
    }
    const float together = settings.hand_stiffness + coupling.stiffness;
    EXPECT_NEAR(hand.motion().pose.translation.x(), depth * settings.hand_stiffness / together,
                settings.friction / together * 1.001f);
    EXPECT_LT(contact_speed, 1e-4f) << "the hand rattles on the wall";
}

TEST_P(HandStep, SteadyLagExcludesHandDamping) {
    // Hand damping acts against the goal's velocity, so in steady motion only the device's own damping and
    // friction hold the hand back: lag = (b v + F) / k.
    const HandSettings settings;
    const float speed = 0.05f;
    HandDevice hand(settings, at(0));
    float goal = 0;
    for (int i = 0; i < static_cast<int>(2.0f / GetParam()); ++i) {
        goal += speed * GetParam();
        hand.step(at(goal), {}, GetParam());
    }
    const float lag = (settings.device_damping * speed + settings.friction) / settings.hand_stiffness;
    // Backward Euler is exact for steady motion but evaluates the spring at the step's end; rounding of a
    // position of 0.1 m is 7e-9 m, and of a finite-difference speed 7e-9 / dt.
    EXPECT_NEAR(goal - hand.motion().pose.translation.x(), lag, 0.05f * lag + 1e-6f);
}

INSTANTIATE_TEST_SUITE_P(Steps, HandStep, testing::Values(0.25e-3f, 1e-3f, 2e-3f), [](const auto& step) {
    return std::to_string(static_cast<int>(std::lround(step.param * 1e6f))) + "us";
});

TEST(Hand, ReportsAtEncoderResolution) {
    HandSettings settings;
    HandDevice hand(settings, at(0.0123456f));
    const float reported = hand.reported().translation.x();
    EXPECT_NEAR(reported, 0.0123456f, 0.5f * settings.encoder_step + 1e-8f);
    EXPECT_NEAR(std::remainder(reported, settings.encoder_step), 0.0f, 2e-9f);
    settings.encoder_step = 0;
    EXPECT_EQ(HandDevice(settings, at(0.0123456f)).reported().translation.x(), 0.0123456f);
}

TEST(Hand, RecoversFromABadSample) {
    const float bad = std::numeric_limits<float>::quiet_NaN();
    HandDevice hand(HandSettings{}, at(0));
    hand.step(at(bad), {}, 1e-3f);
    hand.step(at(0), {Vec3f(bad, 0, 0), Vec3f::Zero()}, 1e-3f);
    hand.step(at(0), {Vec3f::Zero(), Vec3f(0, bad, 0)}, 1e-3f);
    hand.step(at(0.001f), {}, 0.0f);
    settle(hand, at(0.01f), {});
    EXPECT_NEAR(hand.motion().pose.translation.x(), 0.01f, 1e-4f);
}

}  // namespace
}  // namespace eti
