// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/recorded.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/session/writer.hpp"
#include "devices/sensor/device_error.hpp"

namespace eti::devices {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::string& file) {
    SensorSetup setup;
    setup.source = file;
    try {
        (void)open_recorded(setup);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "opened";
}

class RecordedDriver : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }

    /// The blade moves along x at 0.1 m/s and turns about z at 1 rad/s; the tube stays behind.
    void record(int steps) {
        std::filesystem::remove(file_);
        session::SessionWriter writer(file_, {}, {}, {});
        for (int i = 0; i < steps; ++i) {
            session::StepRecord step;
            const float t = static_cast<float>(i) / 180.0f;
            step.step = static_cast<std::uint64_t>(i);
            step.time_ns = static_cast<std::uint64_t>(i) * 1'000'000'000 / 180;
            step.laryngoscope = {quaternion_from({0, 0, t}), {0.1f * t, 0, 0}};
            step.tube_grip.translation = {0, 0.5f, 0};
            ASSERT_TRUE(writer.push(step));
        }
        ASSERT_TRUE(writer.close());
    }

    std::string file_ = testing::TempDir() + "eti_recorded_" + std::to_string(::getpid()) + ".eti.h5";
};

TEST_F(RecordedDriver, FollowsTheRecordingAtItsSimulationTimes) {
    record(181);
    SensorSetup setup;
    setup.source = file_;
    const auto device = open_recorded(setup);
    Observation seen;
    Reading reading;
    for (int i = 0; i <= 500; ++i) {
        seen.time = 1e-3 * i;
        device->look(seen);
        reading = device->exchange({}, 1e-3f);
        // Between steps too: straight lines between points of a straight line, to float rounding.
        ASSERT_NEAR(reading.motion.pose.translation.x(), 1e-4f * static_cast<float>(i), 1e-6f);
        ASSERT_NEAR(rotation_vector(reading.motion.pose.rotation).z(), 1e-3f * static_cast<float>(i), 1e-5f);
    }
    EXPECT_NEAR(reading.motion.velocity.x(), 0.1f, 1e-3f);
    EXPECT_FALSE(device->finished());
    seen.time = 7.0;
    device->look(seen);
    EXPECT_NEAR(device->exchange({}, 1e-3f).motion.pose.translation.x(), 0.1f, 1e-6f);
    EXPECT_TRUE(device->finished());
    seen.time = 0.0;  // another session begins
    device->look(seen);
    EXPECT_NEAR(device->exchange({}, 1e-3f).motion.pose.translation.x(), 0.0f, 1e-6f);
    setup.tool = Tool::tube;
    EXPECT_EQ(open_recorded(setup)->exchange({}, 0.0f).motion.pose.translation, Vec3f(0, 0.5f, 0));
}

TEST_F(RecordedDriver, FilesThatAreNoneAreRefused) {
    EXPECT_THAT(refusal(""), HasSubstr("--source"));
    EXPECT_THAT(refusal("/nowhere/x.eti.h5"), HasSubstr("/nowhere/x.eti.h5"));
    std::ofstream(file_) << "this is no session";
    EXPECT_THAT(refusal(file_), HasSubstr(file_));
    record(0);
    EXPECT_THAT(refusal(file_), HasSubstr("no steps"));
}

}  // namespace
}  // namespace eti::devices
