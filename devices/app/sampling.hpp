// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "common/process/threads/mailbox.hpp"
#include "devices/sensor/sensor_monitor.hpp"

namespace eti::devices {

/// Reads a device without forces: in the device's own servo thread if it has one, else in read().
class ServoReading final : private ServoCycle {
  public:
    explicit ServoReading(SensorMonitor& watch) : watch_(watch), on_servo_(watch_.start_servo(*this)) {}
    ~ServoReading() override;
    ServoReading(const ServoReading&) = delete;
    ServoReading& operator=(const ServoReading&) = delete;

    [[nodiscard]] bool on_servo() const { return on_servo_; }
    /// Call from one thread, and only if the device has no servo thread.
    void read() { servo_cycle(); }

    /// The newest reading; true if it has not been read before. Call from one thread.
    [[nodiscard]] bool newest(Reading& reading);

  private:
    void servo_cycle() noexcept override;

    SensorMonitor& watch_;
    Mailbox<Reading> newest_;
    std::int64_t last_ = 0;  // [ns], CLOCK_MONOTONIC, of the last cycle
    bool on_servo_;
};

/// Reads a device without forces, in its servo thread or in an own thread at 250 Hz, for programs that only
/// need its pose.
class Sampling {
  public:
    explicit Sampling(std::unique_ptr<Sensor> device);
    ~Sampling();
    Sampling(const Sampling&) = delete;
    Sampling& operator=(const Sampling&) = delete;

    /// The newest reading; true if it has not been read before.
    [[nodiscard]] bool newest(Reading& reading) { return reading_.newest(reading); }
    [[nodiscard]] SensorMonitor& watch() { return watch_; }

  private:
    std::unique_ptr<Sensor> device_;
    SensorMonitor watch_;
    ServoReading reading_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::devices
