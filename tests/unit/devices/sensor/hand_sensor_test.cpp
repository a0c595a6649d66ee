// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/hand_sensor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/device/hand.hpp"
#include "devices/sensor/sensor_monitor.hpp"

namespace eti::devices {
namespace {

constexpr float hand_dt = 1e-3f;
constexpr float encoder_step = HandSettings{}.encoder_step;

/// A blade that moves to the mouth opening, 5 cm in front of the origin, and on to the vallecula.
SensorSetup scripted() {
    SensorSetup setup;
    setup.script.emplace();
    Stage to_mouth;
    to_mouth.name = "to the mouth";
    to_mouth.tip_at = Landmark::mouth_opening;
    to_mouth.axis_from = Landmark::mouth_opening;
    to_mouth.axis_to = Landmark::vallecula;
    to_mouth.speed = 0.06f;
    Stage on = to_mouth;
    on.name = "to the vallecula";
    on.tip_at = Landmark::vallecula;
    setup.script->laryngoscope.stages = {to_mouth, on};
    setup.script->tremor = 0.0f;
    setup.tool_length = 0.1f;
    for (Vec3f& point : setup.start.landmarks) {
        point = {0.0f, 0.02f, -0.03f};
    }
    setup.start.landmarks[static_cast<std::size_t>(Landmark::mouth_opening)] = {0.0f, -0.05f, 0.0f};
    setup.start.landmarks[static_cast<std::size_t>(Landmark::vallecula)] = {0.0f, 0.03f, -0.02f};
    return setup;
}

Vec3f tip_of(const RigidTransform& pose) {
    return pose * Vec3f(0.0f, 0.0f, 0.1f);
}

Reading run(HandSensor& sensor, Observation seen, double from, double to) {
    Reading reading;
    for (double t = from; t < to; t += 1e-3) {
        seen.time = t;
        sensor.observe(seen);
        reading = sensor.exchange({}, hand_dt);
    }
    return reading;
}

TEST(HandSensor, WithoutAScriptItStaysParked) {
    for (const Tool tool : {Tool::laryngoscope, Tool::tube}) {
        HandSensor sensor({.tool = tool, .script = {}, .tool_length = 0.1f, .start = {}});
        for (int i = 0; i < 2000; ++i) {
            sensor.observe({});
            const Reading reading = sensor.exchange({}, hand_dt);
            // Rounding to the encoder's step, per axis.
            ASSERT_LT((reading.motion.pose.translation - parked_pose(tool).translation).cwiseAbs().maxCoeff(),
                      0.51f * encoder_step);
        }
        // A finger's width from the face is not well clear of it: 10 cm is.
        EXPECT_GT(parked_pose(tool).translation.norm(), 0.1f);
    }
}

// A steady force against the hand's spring: x = (F - friction .. F + friction) / k.
TEST(HandSensor, DeflectsByItsStiffness) {
    HandSensor sensor({.tool = Tool::laryngoscope, .script = {}, .tool_length = 0.1f, .start = {}});
    const HandSettings hand;
    Wrench wrench;
    wrench.force = {0.0f, 3.0f, 0.0f};
    Reading reading;
    for (int i = 0; i < 3000; ++i) {
        reading = sensor.exchange(wrench, hand_dt);
    }
    const float moved = reading.motion.pose.translation.y() - parked_pose(Tool::laryngoscope).translation.y();
    EXPECT_NEAR(moved, 3.0f / hand.hand_stiffness,
                hand.friction / hand.hand_stiffness + 0.51f * encoder_step);
}

TEST(HandSensor, FollowsItsScriptInSimulationTime) {
    const SensorSetup setup = scripted();
    HandSensor sensor(setup);
    EXPECT_FALSE(sensor.finished());
    // Way in: 4 cm at 6 cm/s mean peak speed takes 1.25 s (minimum jerk peaks at 15/8 of its mean); then 8.2
    // cm takes 2.6 s. At 2 s it is in the second stage, at 5 s it is done.
    run(sensor, setup.start, 0.0, 1.2);
    EXPECT_FALSE(sensor.finished());
    const Reading end = run(sensor, setup.start, 1.2, 5.0);
    EXPECT_TRUE(sensor.finished());
    const Vec3f goal = setup.start.landmarks[static_cast<std::size_t>(Landmark::vallecula)];
    // Friction holds the hand off its goal by 0.05 N / 900 N/m; the orientation is frictionless.
    EXPECT_LT((tip_of(end.motion.pose) - goal).norm(), 0.2e-3f);
}

TEST(HandSensor, AFrozenSimulationFreezesTheScript) {
    const SensorSetup setup = scripted();
    HandSensor sensor(setup);
    const Reading before = run(sensor, setup.start, 0.0, 0.6);
    Observation seen = setup.start;
    seen.time = 0.6;
    Reading after;
    for (int i = 0; i < 2000; ++i) {
        sensor.observe(seen);
        after = sensor.exchange({}, hand_dt);
    }
    // In two seconds the script would have moved by more than 4 cm; the hand only catches up with its former
    // goal (18 N s/m over 900 N/m at 6 cm/s: about a millimetre).
    EXPECT_LT((after.motion.pose.translation - before.motion.pose.translation).norm(), 3e-3f);
}

TEST(HandSensor, NewSessionRestartsScriptAtHandSpeed) {
    const SensorSetup setup = scripted();
    HandSensor sensor(setup);
    const Reading start = run(sensor, setup.start, 0.0, 0.002);
    run(sensor, setup.start, 0.0, 5.0);
    ASSERT_TRUE(sensor.finished());
    Observation seen = setup.start;
    float fastest = 0.0f;
    Reading reading;
    for (double t = 0.0; t < 0.3; t += 1e-3) {
        seen.time = t;
        sensor.observe(seen);
        reading = sensor.exchange({}, hand_dt);
        fastest = std::max(fastest, reading.motion.velocity.norm());
    }
    EXPECT_FALSE(sensor.finished());
    EXPECT_LT((reading.motion.pose.translation - start.motion.pose.translation).norm(), 0.02f);
    // Goal at 1 m/s; the hand's spring and damper overshoot a step in speed by less than half.
    EXPECT_LT(fastest, 1.5f);
}

// The scripted hand may receive an invalid scene; the device's motion stays valid.
TEST(HandSensor, InvalidSceneMovesDeviceAtHandSpeed) {
    const SensorSetup setup = scripted();
    HandSensor sensor(setup);
    SensorMonitor watch(sensor);
    Observation seen = setup.start;
    Reading reading;
    const auto pass = [&](double seconds) {
        for (const double end = seen.time + seconds; seen.time < end; seen.time += 1e-3) {
            watch.observe(seen);
            reading = watch.exchange({}, hand_dt);
            ASSERT_TRUE(reading.present);
            ASSERT_TRUE(reading.motion.pose.translation.allFinite());
        }
    };
    pass(0.5);
    for (Vec3f& point : seen.landmarks) {
        point.x() += 1.0f;
    }
    pass(0.5);
    for (Vec3f& point : seen.landmarks) {
        point.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
    pass(0.5);
    seen.landmarks = setup.start.landmarks;
    for (Vec3f& point : seen.landmarks) {
        point.x() *= -1.0f;
    }
    pass(0.5);
    EXPECT_EQ(watch.health().jumps, 0u);
    EXPECT_EQ(watch.health().not_finite, 0u);
}

// Updates ten times a second only: the script advances in steps, the device moves smoothly.
TEST(HandSensor, ASceneAtTenHertzIsFollowedWithoutJumps) {
    const SensorSetup setup = scripted();
    HandSensor sensor(setup);
    SensorMonitor watch(sensor);
    Observation seen = setup.start;
    for (int i = 0; i < 3000; ++i) {
        if (i % 100 == 0) {
            seen.time = 1e-3 * i;
            watch.observe(seen);
        }
        ASSERT_TRUE(watch.exchange({}, hand_dt).present);
    }
    EXPECT_EQ(watch.health().jumps, 0u);
}

TEST(HandSensor, LateCyclesAdvanceAsFarAsPunctualOnes) {
    Wrench push;
    push.force = {0.0f, 0.0f, 1.0f};
    HandSensor punctual({.tool = Tool::laryngoscope, .script = {}, .tool_length = 0.1f, .start = {}});
    HandSensor late({.tool = Tool::laryngoscope, .script = {}, .tool_length = 0.1f, .start = {}});
    Reading a, b;
    for (int i = 0; i < 12; ++i) {
        a = punctual.exchange(push, hand_dt);
    }
    for (int i = 0; i < 3; ++i) {
        b = late.exchange(push, 4.0f * hand_dt);
    }
    // The same steps were taken; 4 ms is not exactly four times 1 ms in float, which leaves a fraction of a
    // step.
    EXPECT_LT((a.motion.pose.translation - b.motion.pose.translation).norm(), 1.1f * encoder_step);
    EXPECT_LT((a.motion.velocity - b.motion.velocity).norm(), 1e-3f);
}

}  // namespace
}  // namespace eti::devices
