// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>

#include "common/process/threads/mailbox.hpp"
#include "devices/sensor/device_error.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// A measurement of a device that is polled or waited for.
struct Sample {
    RigidTransform pose;
    std::uint32_t buttons = 0;
    std::array<float, axis_count> axes{};
};

/// A device that is read by blocking calls, all from one thread; all may throw DeviceError.
class SampleSource {
  public:
    virtual ~SampleSource() = default;
    /// Opens the device, for the first time or after a loss.
    virtual void open() = 0;
    /// Updates `sample` to the next sample; waits at most `read_timeout`. False: nothing new, which is not an
    /// error.
    [[nodiscard]] virtual bool read(Sample& sample) = 0;
    virtual void close() noexcept = 0;
    /// [1/s], nominal sample rate; 0: samples only when something changes.
    [[nodiscard]] virtual float rate() const { return 0.0f; }

    static constexpr std::chrono::milliseconds read_timeout{20};
};

/// Reads a source on its own thread and passes the newest sample to the loop, which never waits. A source
/// that fails is closed and reopened once a second until it is back.
class PolledSensor final : public Sensor {
  public:
    /// Opens the source; throws DeviceError when that fails.
    explicit PolledSensor(std::unique_ptr<SampleSource> source, const RigidTransform& start);
    ~PolledSensor() override;

    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override;
    [[nodiscard]] DeviceCapabilities capabilities() const override;
    [[nodiscard]] std::string fault() const override;

  private:
    /// Data passed on by the thread.
    struct Measured {
        Sample sample;
        Vec3f velocity = Vec3f::Zero(), angular_velocity = Vec3f::Zero();
        std::uint64_t number = 0;
    };

    void run();
    void estimate_velocity(const RigidTransform& pose, std::int64_t now);
    void report(const std::string& fault);

    std::unique_ptr<SampleSource> source_;
    Measured measured_;  // the thread's
    RigidTransform last_pose_;
    std::int64_t measured_at_ = 0;  // [ns]; 0: no measurement yet
    Mailbox<Measured> newest_;
    std::uint64_t calls_ = 0;
    std::atomic<bool> present_{true}, ending_{false};
    mutable std::mutex mutex_;
    std::string fault_;  // guarded by mutex_
    std::thread thread_;
};

}  // namespace eti::devices
