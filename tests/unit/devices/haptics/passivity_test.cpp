// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/passivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numbers>

namespace eti::devices {
namespace {

constexpr float passivity_dt = 1e-3f;

Motion at(float x, float v) {
    return {{Quatf::Identity(), {x, 0, 0}}, {v, 0, 0}, Vec3f::Zero()};
}

// A spring pressed to 2 mm and released in slow steps: the observer has k x^2 / 2 at the bottom, and in the
// end only what holding the force over a cycle generates, k v^2 T t.
TEST(Passivity, ObserverMeasuresSpringEnergy) {
    PassivityController controller({.on = false});
    constexpr float k = 800.0f;
    constexpr int cycles = 2000;
    float x = 0.0f;
    double deepest = 0.0;
    for (int i = 0; i <= cycles; ++i) {
        const float phase = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / cycles;
        const float next = 1e-3f * (1.0f - std::cos(phase));
        (void)controller.apply({{-k * next, 0, 0}, Vec3f::Zero()}, at(next, (next - x) / passivity_dt),
                               passivity_dt);
        x = next;
        deepest = std::max(deepest, controller.stored());
    }
    const double full = 0.5 * static_cast<double>(k) * 4e-6;
    EXPECT_NEAR(deepest, full, 0.005 * full);
    EXPECT_NEAR(controller.stored(), 0.0, 0.005 * full);
}

TEST(Passivity, PassiveForceIsUnchanged) {
    PassivityController controller;
    for (int i = 0; i < 5000; ++i) {
        const float t = passivity_dt * static_cast<float>(i);
        const float x = 5e-3f * std::sin(20.0f * t), v = 0.1f * std::cos(20.0f * t);
        const Wrench wanted{{-5.0f * v, 0, 0}, {0, 0, 0.01f}};
        const Wrench given = controller.apply(wanted, at(x, v), passivity_dt);
        // The first cycle over a turning point may return a little of the stored energy.
        if (controller.stored() > 0.0) {
            ASSERT_EQ((given.force - wanted.force).norm(), 0.0f);
        }
    }
    EXPECT_LT(controller.dissipated(), 1e-5);
}

/// A mass of 0.15 kg with 1 N s/m on a wall whose force is delayed by a number of cycles. The closed form
/// gives stability up to b / (T / 2 + delay) (Gil et al. 2009), 41 N/m here for 24 ms.
struct DelayedWall {
    PassivityController controller;
    float stiffness = 400.0f;
    std::deque<float> late = std::deque<float>(24, 0.0f);

    /// Largest excursion [m] in the last of ten seconds after a push.
    float run() {
        float x = 0.0f, v = 0.05f, most = 0.0f;
        for (int i = 0; i < 10000; ++i) {
            late.push_back(-stiffness * x);
            const Wrench given =
                controller.apply({{late.front(), 0, 0}, Vec3f::Zero()}, at(x, v), passivity_dt);
            late.pop_front();
            v += passivity_dt * (given.force.x() - 1.0f * v) / 0.15f;
            v = std::clamp(v, -5.0f, 5.0f);
            x += passivity_dt * v;
            most = i > 9000 ? std::max(most, std::abs(x)) : most;
        }
        return most;
    }
};

TEST(Passivity, ControllerStabilizesADelayedWall) {
    DelayedWall alone{PassivityController({.on = false})};
    EXPECT_GT(alone.run(), 0.05f);
    EXPECT_LT(alone.controller.lowest(), -1e-3);
    DelayedWall held{PassivityController(PassivitySettings{})};
    EXPECT_LT(held.run(), 2e-3f);
    EXPECT_GT(held.controller.dissipated(), 0.0);
    EXPECT_GT(held.controller.active_cycles(), 100u);
}

TEST(Passivity, DampingIsBoundedAndEnergyResetsAfterContact) {
    PassivityController controller;
    for (int i = 0; i < 100; ++i) {
        const Wrench wanted{{5.0f, 0, 0}, Vec3f::Zero()};
        const Wrench given = controller.apply(wanted, at(1e-4f * static_cast<float>(i), 0.1f), passivity_dt);
        ASSERT_LE((given.force - wanted.force).norm(), PassivitySettings{}.max_damping * 0.1f * 1.001f);
    }
    EXPECT_LT(controller.stored(), -0.01);
    for (int i = 0; i < 60; ++i) {
        (void)controller.apply({}, at(0.01f, 0.0f), passivity_dt);
    }
    EXPECT_EQ(controller.stored(), 0.0);
}

}  // namespace
}  // namespace eti::devices
