// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "devices/haptics/haptic_loop.hpp"
#include "devices/sensor/hand_sensor.hpp"
#include "devices/sensor/sensor_monitor.hpp"
#include "tests/support/allocations.hpp"

namespace eti::devices {
namespace {

constexpr std::int64_t ms = 1'000'000;

SensorSetup setup_with_script() {
    SensorSetup setup;
    setup.script.emplace();
    Stage stage;
    stage.name = "a name too long for a string's own buffer";
    stage.tip_at = Landmark::mouth_opening;
    stage.axis_from = Landmark::upper_gum;
    stage.axis_to = Landmark::vallecula;
    stage.speed = 0.2f;
    setup.script->laryngoscope.stages = {stage, stage, stage};
    setup.script->laryngoscope.stages[1].tip_at = Landmark::vallecula;
    setup.script->tremor = 0.3e-3f;
    for (std::size_t i = 0; i < landmark_count; ++i) {
        setup.start.landmarks[i] =
            Vec3f(0.0f, 0.004f * static_cast<float>(i), -0.003f * static_cast<float>(i * i));
    }
    return setup;
}

/// A device shaken by a pressing hand, so that forces do work and the controller is active.
class Shaken final : public Sensor {
  public:
    Reading exchange(const Wrench& wrench, float) override {
        torque = std::max(torque, wrench.torque.norm());
        const float phase = 0.05f * static_cast<float>(++cycle_);
        Reading reading;
        reading.motion.pose = {quaternion_from({0.05f * std::sin(phase), 0, 0}),
                               {0, -3e-3f + 2e-3f * std::sin(phase), 0}};
        reading.motion.velocity = {0, 0.1f * std::cos(phase), 0};
        reading.motion.angular_velocity = {2.5f * std::cos(phase), 0, 0};
        reading.sample = static_cast<std::uint64_t>(cycle_);
        return reading;
    }
    float torque = 0.0f;  // [N m], maximum

  private:
    int cycle_ = 0;
};

/// The blade in a corner of the shell and on tissue, rotated back; the message is late and behind the hand.
SceneState pressed_state(int cycle) {
    SceneState state;
    state.blade = make_laryngoscope(Blade::miller_1).capsules;
    // Forces engage while there is no contact.
    if (cycle < 600) {
        state.proxy.device.translation = state.proxy.proxy.pose.translation = {0, -3e-3f, 0};
        return state;
    }
    state.proxy.proxy.pose.rotation =
        quaternion_from({0.05f * std::sin(0.01f * static_cast<float>(cycle)), 0, 0});
    state.proxy.proxy.angular_velocity = {0.5f, 0, 0};
    state.proxy.device.translation = {0, -3e-3f, 0};
    state.proxy.contacts = ProxyReport::max_contacts;
    for (std::size_t i = 0; i < state.proxy.contacts; ++i) {
        state.proxy.normals[i] = Vec3f(0.1f * static_cast<float>(i), 1.0f, 0).normalized();
    }
    state.proxy.contact_centre = {0, 0, 0.05f};
    state.tissue.wrench = {{0, 0.5f + 0.4f * std::sin(0.03f * static_cast<float>(cycle)), 0}, {0.01f, 0, 0}};
    state.tissue.count = TissueReport::max_points;
    for (std::size_t i = 0; i < state.tissue.count; ++i) {
        const float z = 1e-3f * static_cast<float>(i);
        state.tissue.points[i] = {{0, -2e-3f, z}, {0, 1e-3f, z}, 1e-3f, Tissue::tongue, {0, 0.005f, 0}};
    }
    return state;
}

/// Allocations of that many cycles, each with the messages that `scene` returns for it.
template <class Scene>
long allocations_of(int cycles, HapticCycle& cycle, Mailbox<SceneState>& newest, const Scene& scene) {
    const long before = test::allocations_here();
    for (int i = 1; i <= cycles; ++i) {
        if (i % 6 == 0) {
            SceneState state = scene(i);
            state.proxy_arrived = state.tissue_arrived = 1'000 * ms + i * ms;
            newest.write(state);
        }
        (void)cycle.run(1'000 * ms + i * ms);
    }
    return test::allocations_here() - before;
}

TEST(HapticCycle, AllocatesNothing) {
    const SensorSetup setup = setup_with_script();
    HandSensor sensor(setup);
    auto scene = std::make_unique<Mailbox<SceneState>>();
    HapticCycle cycle(sensor, *scene, {});
    const auto free = [&](int i) {
        // Half-way another session begins and the script restarts.
        SceneState state;
        state.seen = setup.start;
        state.session = i < 3000 ? 0 : 1;
        state.seen.time = 1e-3 * (i < 3000 ? i : i - 3000);
        return state;
    };
    EXPECT_EQ(allocations_of(6000, cycle, *scene, free), 0);
    const long before = test::allocations_here();
    const auto proof = std::make_unique<int>(1);
    EXPECT_EQ(test::allocations_here(), before + 1) << "allocations are not counted";
}

TEST(HapticCycle, AllocatesNothingInContact) {
    for (const SoftForce law : {SoftForce::constraint, SoftForce::displacement}) {
        for (const bool torque : {true, false}) {
            RenderSettings settings;
            settings.soft_force = law;
            settings.torque = torque;
            settings.gimbal = {0, 0.06f, 0};
            Shaken device;
            SensorMonitor watch(device);
            auto scene = std::make_unique<Mailbox<SceneState>>();
            HapticCycle cycle(watch, *scene, settings);
            EXPECT_EQ(allocations_of(3000, cycle, *scene, pressed_state), 0);
            // Skipped computations allocate nothing either.
            EXPECT_GT(cycle.record().force_max, 1.0f);
            EXPECT_GT(cycle.renderer().passivity().active_cycles(), 0u);
            EXPECT_EQ(device.torque > 0.01f, torque);
        }
    }
}

TEST(HapticCycle, AllocatesNothingWhenReleasingAForce) {
    Shaken device;
    auto scene = std::make_unique<Mailbox<SceneState>>();
    HapticCycle cycle(device, *scene, {});
    const auto not_finite = [](int i) {
        SceneState state = pressed_state(i);
        state.tissue.wrench.force.x() = i % 500 < 100 ? std::numeric_limits<float>::quiet_NaN() : 0.0f;
        return state;
    };
    EXPECT_EQ(allocations_of(3000, cycle, *scene, not_finite), 0);
    EXPECT_GT(cycle.renderer().not_finite(), 0u);
    const long before = test::allocations_here();
    for (int i = 3000; i < 3400; ++i) {
        (void)cycle.run(1'000 * ms + i * ms, i % 2 == 0);  // no messages, and the panic key
    }
    EXPECT_EQ(test::allocations_here(), before);
    EXPECT_GT(cycle.record().stale_cycles, 0u);
}

/// A device that may be disconnected.
class Coming final : public Sensor {
  public:
    Reading exchange(const Wrench& wrench, float) override {
        given = wrench;
        Reading reading;
        reading.present = present;
        return reading;
    }
    bool present = true;
    Wrench given;
};

TEST(HapticCycle, DeviceLossOrStopZeroesForceImmediately) {
    Coming sensor;
    auto scene = std::make_unique<Mailbox<SceneState>>();
    HapticCycle cycle(sensor, *scene, {});
    SceneState state;
    std::int64_t now = 1'000 * ms;
    const auto pass = [&](int cycles, float force, bool stop = false) {
        bool published = false;
        for (int i = 0; i < cycles; ++i) {
            now += ms;
            state.proxy_arrived = state.tissue_arrived = now;
            state.tissue.wrench.force.x() = force;
            scene->write(state);
            published = cycle.run(now, stop).has_value();
        }
        return published;
    };
    EXPECT_TRUE(pass(600, 0.0f));
    EXPECT_TRUE(pass(100, 2.0f));
    EXPECT_NEAR(sensor.given.force.x(), 2.0f, 1e-5f);
    sensor.present = false;
    EXPECT_FALSE(pass(1, 2.0f)) << "a pose that is not there is not published";
    EXPECT_FALSE(pass(1, 2.0f));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f);
    sensor.present = true;
    EXPECT_TRUE(pass(300, 2.0f));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f) << "not quiet yet";
    pass(600, 0.0f);
    pass(100, 2.0f);
    EXPECT_NEAR(sensor.given.force.x(), 2.0f, 1e-5f);
    EXPECT_TRUE(pass(1, 2.0f, true));
    EXPECT_EQ(sensor.given.force.norm(), 0.0f);
    EXPECT_EQ(cycle.record().emergency_stop_cycles, 1u);
    EXPECT_EQ(cycle.record().absent_cycles, 2u);
}

TEST(SimulationTime, IsExtrapolatedByAtMostTwoSteps) {
    SimulationTime time;
    SceneState scene;
    scene.seen.time = 3.0;
    scene.proxy_arrived = 1'000 * ms;
    scene.pace = 0.5f;
    EXPECT_NEAR(time.at(scene, 1'004 * ms), 3.002, 1e-9);
    EXPECT_NEAR(time.at(scene, 5'000 * ms), 3.0 + 2.0 / 180.0, 1e-9);
    // The next message is about an earlier time than predicted: time stops, it does not go back.
    scene.seen.time = 3.0 + 1.0 / 180.0;
    scene.proxy_arrived = 5'000 * ms;
    EXPECT_NEAR(time.at(scene, 5'001 * ms), 3.0 + 2.0 / 180.0, 1e-9);
    // Another session starts at its own time.
    scene.session = 1;
    scene.seen.time = 0.0;
    EXPECT_NEAR(time.at(scene, 5'002 * ms), 0.001, 1e-9);
}

}  // namespace
}  // namespace eti::devices
