// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/recorded.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "common/math/random.hpp"
#include "common/session/writer.hpp"
#include "devices/sensor/device_error.hpp"
#include "devices/sensor/sensor_monitor.hpp"
#include "tests/support/error_of.hpp"

namespace eti::devices {
namespace {

using ::testing::HasSubstr;

std::string recording_refusal(const std::string& file) {
    SensorSetup setup;
    setup.source = file;
    return test::error_of<DeviceError>([&] { (void)open_recorded(setup); });
}

class RecordedDriver : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }

    /// The blade moves along x at 0.1 m/s and rotates about z at 1 rad/s; the tube stays behind.
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
        device->observe(seen);
        reading = device->exchange({}, 1e-3f);
        // Also between steps: points on a straight line are interpolated exactly, up to float rounding.
        ASSERT_NEAR(reading.motion.pose.translation.x(), 1e-4f * static_cast<float>(i), 1e-6f);
        ASSERT_NEAR(rotation_vector(reading.motion.pose.rotation).z(), 1e-3f * static_cast<float>(i), 1e-5f);
    }
    EXPECT_NEAR(reading.motion.velocity.x(), 0.1f, 1e-3f);
    EXPECT_FALSE(device->finished());
    seen.time = 7.0;
    device->observe(seen);
    EXPECT_NEAR(device->exchange({}, 1e-3f).motion.pose.translation.x(), 0.1f, 1e-6f);
    EXPECT_TRUE(device->finished());
    seen.time = 0.0;  // another session begins
    device->observe(seen);
    EXPECT_NEAR(device->exchange({}, 1e-3f).motion.pose.translation.x(), 0.0f, 1e-6f);
    setup.tool = Tool::tube;
    EXPECT_EQ(open_recorded(setup)->exchange({}, 0.0f).motion.pose.translation, Vec3f(0, 0.5f, 0));
}

/// A second of a recording at `rate` [1/s], corrupted half-way by `spoil`, read through a monitor.
struct Played {
    SensorHealth health;
    float farthest = 0.0f;  ///< [m], maximum displacement of the device passed on in a cycle
    bool finite = true, present = false;
};

class ImplausibleRecording : public RecordedDriver {
  protected:
    Played play(int rate, const std::function<void(session::StepRecord&)>& spoil) {
        std::filesystem::remove(file_);
        {
            session::SessionWriter writer(file_, {}, {}, {});
            for (int i = 0; i <= rate; ++i) {
                session::StepRecord step;
                step.step = static_cast<std::uint64_t>(i);
                step.time_ns =
                    static_cast<std::uint64_t>(i) * 1'000'000'000 / static_cast<std::uint64_t>(rate);
                step.laryngoscope.translation = {0.1f * static_cast<float>(i) / static_cast<float>(rate), 0,
                                                 0};
                if (2 * i > rate) {
                    spoil(step);
                }
                EXPECT_TRUE(writer.push(step));
            }
            EXPECT_TRUE(writer.close());
        }
        SensorSetup setup;
        setup.source = file_;
        const auto device = open_recorded(setup);
        SensorMonitor watch(*device);
        Played played;
        Observation seen;
        Vec3f last = watch.exchange({}, 0.0f).motion.pose.translation;
        for (int i = 0; i < 700; ++i) {
            seen.time = 1e-3 * i;
            watch.observe(seen);
            const Reading reading = watch.exchange({}, 1e-3f);
            const Vec3f at = reading.motion.pose.translation;
            played.farthest = std::max(played.farthest, (at - last).norm());
            played.finite = played.finite && at.allFinite();
            played.present = reading.present;
            last = at;
        }
        played.health = watch.health();
        return played;
    }
    static constexpr float hand = 3.0f * 1e-3f + 5e-3f;  // [m], what a monitor accepts per millisecond
};

TEST_F(ImplausibleRecording, OneMetreJumpIsNotFollowed) {
    const Played played =
        play(180, [](session::StepRecord& step) { step.laryngoscope.translation.y() = 1.0f; });
    EXPECT_GT(played.health.jumps, 0u);
    EXPECT_LT(played.farthest, hand);
}

TEST_F(ImplausibleRecording, NonFiniteSamplesAreSkipped) {
    const Played played = play(180, [](session::StepRecord& step) {
        step.laryngoscope.translation.z() = std::numeric_limits<float>::quiet_NaN();
    });
    EXPECT_GT(played.health.not_finite, 0u);
    EXPECT_TRUE(played.finite);
    EXPECT_FALSE(played.present);
}

TEST_F(ImplausibleRecording, InvalidRotationIsSkipped) {
    const Played played =
        play(180, [](session::StepRecord& step) { step.laryngoscope.rotation = Quatf(0, 0, 0, 0); });
    EXPECT_GT(played.health.not_finite, 0u);
    EXPECT_FALSE(played.present);
}

TEST_F(ImplausibleRecording, FrozenAndTenHertzCauseNoJumps) {
    const Played frozen =
        play(180, [](session::StepRecord& step) { step.laryngoscope.translation.x() = 0.05f; });
    EXPECT_TRUE(frozen.present);
    EXPECT_EQ(frozen.health.jumps, 0u);
    const Played slow = play(10, [](session::StepRecord&) {});
    EXPECT_EQ(slow.health.jumps, 0u);
    EXPECT_LT(slow.farthest, 2e-4f) << "0.1 m/s, between its steps too";
}

// Deleting the file is like unplugging the device. It was read completely when it was opened.
TEST_F(RecordedDriver, FileDeletedDuringPlaybackIsHarmless) {
    record(181);
    SensorSetup setup;
    setup.source = file_;
    const auto device = open_recorded(setup);
    std::filesystem::remove(file_);
    Observation seen;
    seen.time = 0.5;
    device->observe(seen);
    const Reading reading = device->exchange({}, 1e-3f);
    EXPECT_TRUE(reading.present);
    EXPECT_NEAR(reading.motion.pose.translation.x(), 0.05f, 1e-6f);
}

// A crash of the library that reads it must not crash the device's program.
TEST_F(RecordedDriver, DamagedFileIsRefusedWithoutCrash) {
    record(60);
    std::vector<char> whole(std::filesystem::file_size(file_));
    std::ifstream(file_, std::ios::binary).read(whole.data(), static_cast<std::streamsize>(whole.size()));
    Random random(4);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<char> bytes = whole;
        for (int i = 0; i < 200; ++i) {
            bytes[random.bits() % bytes.size()] = static_cast<char>(random.bits());
        }
        bytes.resize(trial % 4 == 0 ? bytes.size() / 2 : bytes.size());
        std::ofstream(file_, std::ios::binary)
            .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        const std::string said = recording_refusal(file_);
        EXPECT_TRUE(said.empty() || said.find(file_) != std::string::npos) << said;
    }
}

TEST_F(RecordedDriver, InvalidFilesAreRefused) {
    EXPECT_THAT(recording_refusal(""), HasSubstr("--source"));
    EXPECT_THAT(recording_refusal("/nowhere/x.eti.h5"), HasSubstr("/nowhere/x.eti.h5"));
    std::ofstream(file_) << "this is no session";
    EXPECT_THAT(recording_refusal(file_), HasSubstr(file_));
    record(0);
    EXPECT_THAT(recording_refusal(file_), HasSubstr("no steps"));
}

}  // namespace
}  // namespace eti::devices
