// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/sensor_monitor.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace eti::devices {
namespace {

constexpr float watch_dt = 1e-3f;

/// A device with scripted readings.
class SensorDouble final : public Sensor {
  public:
    Reading exchange(const Wrench&, float) override {
        reading.sample += advancing ? 1 : 0;
        return reading;
    }
    [[nodiscard]] DeviceCapabilities capabilities() const override {
        return {.force = 3.0f, .torque = 0.0f, .rate = rate};
    }

    Reading reading;
    bool advancing = true;
    float rate = 0.0f;
};

class WatchedSensor : public ::testing::Test {
  protected:
    Reading cycles(int count) {
        Reading out;
        for (int i = 0; i < count; ++i) {
            out = watch_.exchange({}, watch_dt);
        }
        return out;
    }

    SensorDouble device_;
    SensorMonitor watch_{device_};
};

TEST_F(WatchedSensor, PassesHandMotion) {
    (void)cycles(1);
    for (int i = 0; i < 500; ++i) {
        device_.reading.motion.pose.translation.x() += 1e-3f;  // 1 m/s
        device_.reading.motion.pose.rotation =
            quaternion_from({0.0f, 0.01f, 0.0f}) * device_.reading.motion.pose.rotation;  // 10 rad/s
        const Reading reading = cycles(1);
        ASSERT_TRUE(reading.present);
        ASSERT_EQ(reading.motion.pose.translation, device_.reading.motion.pose.translation);
    }
    EXPECT_EQ(watch_.health().jumps, 0u);
}

TEST_F(WatchedSensor, OneMetreJumpIsIgnoredUntilSettled) {
    (void)cycles(10);
    device_.reading.motion.pose.translation.x() = 1.0f;
    device_.reading.motion.velocity.x() = 1000.0f;
    for (int i = 0; i < 299; ++i) {
        const Reading reading = cycles(1);
        ASSERT_FALSE(reading.present && reading.motion.pose.translation.x() > 0.5f) << i;
        ASSERT_EQ(reading.motion.pose.translation.x(), 0.0f);
        ASSERT_EQ(reading.motion.velocity.norm(), 0.0f);
    }
    const Reading settled = cycles(20);
    EXPECT_TRUE(settled.present);
    EXPECT_EQ(settled.motion.pose.translation.x(), 1.0f);
    EXPECT_GE(watch_.health().jumps, 299u);
}

TEST_F(WatchedSensor, FlickeringBetweenTwoPlacesNeverSettles) {
    (void)cycles(10);
    for (int i = 0; i < 3000; ++i) {
        device_.reading.motion.pose.translation.x() = i % 2 == 0 ? 1.0f : -1.0f;
        ASSERT_EQ(cycles(1).motion.pose.translation.x(), 0.0f) << i;
    }
}

TEST_F(WatchedSensor, NonFinitePosesAreCountedAndRejected) {
    (void)cycles(10);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        device_.reading.motion.pose.translation.y() = bad;
        EXPECT_FALSE(cycles(1).present) << "no force on a pose that is not finite, not for a cycle";
        const Reading reading = cycles(39);
        EXPECT_FALSE(reading.present);
        EXPECT_TRUE(reading.motion.pose.translation.allFinite());
        device_.reading.motion.pose.translation.y() = 0.0f;
        EXPECT_TRUE(cycles(1).present);
    }
    device_.reading.motion.pose.rotation = Quatf(0, 0, 0, 0);
    EXPECT_FALSE(cycles(40).present);
    EXPECT_EQ(watch_.health().not_finite, 120u);
}

TEST_F(WatchedSensor, SuddenRotationIsAJump) {
    (void)cycles(10);
    device_.reading.motion.pose.rotation = quaternion_from({3.0f, 0.0f, 0.0f});
    EXPECT_LT(rotation_vector(cycles(1).motion.pose.rotation).norm(), 1e-6f);
    EXPECT_EQ(watch_.health().jumps, 1u);
}

TEST_F(WatchedSensor, FrozenDeviceGetsNoForceThenIsLost) {
    (void)cycles(10);
    device_.advancing = false;
    EXPECT_TRUE(cycles(20).present);
    EXPECT_FALSE(cycles(10).present);
    EXPECT_FALSE(watch_.health().lost);
    (void)cycles(500);
    EXPECT_TRUE(watch_.health().lost);
    EXPECT_EQ(watch_.health().losses, 1u);
    device_.advancing = true;
    EXPECT_TRUE(cycles(2).present);
    EXPECT_FALSE(watch_.health().lost);
}

/// Cycles of a device of 1 kHz that pushes with `force` [N].
Reading pushed(SensorMonitor& watch, int cycles, float force) {
    Reading out;
    for (int i = 0; i < cycles; ++i) {
        out = watch.exchange({{force, 0, 0}, Vec3f::Zero()}, watch_dt);
    }
    return out;
}

TEST(SensorMonitor, StillPoseUnderForceIsFrozenUntilItMoves) {
    SensorDouble device;
    device.rate = 1000.0f;
    SensorMonitor watch(device);
    EXPECT_TRUE(pushed(watch, 4990, 2.0f).present) << "a still hand";
    EXPECT_FALSE(watch.health().lost);
    EXPECT_FALSE(pushed(watch, 20, 2.0f).present);
    EXPECT_TRUE(watch.health().frozen);
    EXPECT_TRUE(watch.health().lost);
    EXPECT_EQ(watch.health().losses, 1u);
    EXPECT_FALSE(pushed(watch, 5000, 0.0f).present) << "let go, it stays lost";
    device.reading.motion.pose.translation.x() += 0.03e-3f;
    EXPECT_TRUE(pushed(watch, 1, 0.0f).present);
    EXPECT_FALSE(watch.health().frozen);
    EXPECT_FALSE(watch.health().lost);
}

TEST(SensorMonitor, AHandThatHoldsStillIsNotFrozen) {
    SensorDouble device;
    device.rate = 1000.0f;
    SensorMonitor watch(device);
    // At rest without force, for a minute.
    EXPECT_TRUE(pushed(watch, 60'000, 0.1f).present);
    // Under force, it moves by an encoder's step every four seconds.
    for (int i = 0; i < 15; ++i) {
        EXPECT_TRUE(pushed(watch, 4000, 3.0f).present);
        device.reading.motion.pose.translation.x() += i % 2 == 0 ? 0.03e-3f : -0.03e-3f;
    }
    EXPECT_EQ(watch.health().losses, 0u);
    // A simulated hand has no tremor. It has no rate of its own.
    SensorDouble simulated;
    SensorMonitor over(simulated);
    EXPECT_TRUE(pushed(over, 60'000, 3.0f).present);
}

TEST_F(WatchedSensor, UnpluggedDeviceIsLostAndKeepsItsPose) {
    device_.reading.motion.pose.translation = {0.1f, 0.2f, 0.3f};
    device_.reading.buttons = 1;
    (void)cycles(10);
    device_.reading.present = false;
    const Reading reading = cycles(1);
    EXPECT_FALSE(reading.present);
    EXPECT_EQ(reading.buttons, 0u);
    EXPECT_EQ(reading.motion.pose.translation, Vec3f(0.1f, 0.2f, 0.3f));
    EXPECT_TRUE(watch_.health().lost);
}

TEST(SensorMonitor, TenHertzIsReportedAsSlow) {
    SensorDouble device;
    device.rate = 80.0f;
    SensorMonitor watch(device);
    device.advancing = false;
    for (int i = 0; i < 2100; ++i) {
        device.reading.sample = static_cast<std::uint64_t>(i / 100);
        (void)watch.exchange({}, watch_dt);
    }
    EXPECT_TRUE(watch.health().slow);
    EXPECT_FALSE(watch.health().lost);
    EXPECT_NEAR(watch.health().rate, 10.0f, 1.1f);
    for (int i = 0; i < 2100; ++i) {
        device.reading.sample = 100 + static_cast<std::uint64_t>(i / 12);
        (void)watch.exchange({}, watch_dt);
    }
    EXPECT_FALSE(watch.health().slow);
    EXPECT_NEAR(watch.health().rate, 83.0f, 2.0f);
}

}  // namespace
}  // namespace eti::devices
