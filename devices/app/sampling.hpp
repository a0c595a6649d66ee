// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "devices/sensor/sensor_watch.hpp"
#include "devices/sensor/triple_buffer.hpp"

namespace eti::devices {

/// Reads a device without forces in its own servo thread, where it has one; else whoever calls read().
class ServoReading final : private ServoCycle {
  public:
    explicit ServoReading(SensorWatch& watch) : watch_(watch), on_servo_(watch_.start_servo(*this)) {}
    ~ServoReading() override;
    ServoReading(const ServoReading&) = delete;
    ServoReading& operator=(const ServoReading&) = delete;

    [[nodiscard]] bool on_servo() const { return on_servo_; }
    /// From one thread, and only where the device has none.
    void read() { servo_cycle(); }

    /// The newest reading; true when there is one that was not read before. From one thread.
    [[nodiscard]] bool newest(Reading& reading);

  private:
    void servo_cycle() noexcept override;

    SensorWatch& watch_;
    TripleBuffer<Reading> newest_;
    std::int64_t last_ = 0;  // [ns], CLOCK_MONOTONIC, of the last cycle
    bool on_servo_;
};

/// Reads a device without forces, in its servo thread or in one of our own at 250 Hz, for programs that only
/// want to know where it is.
class Sampling {
  public:
    explicit Sampling(std::unique_ptr<Sensor> device);
    ~Sampling();
    Sampling(const Sampling&) = delete;
    Sampling& operator=(const Sampling&) = delete;

    /// The newest reading; true when it was not read before.
    [[nodiscard]] bool newest(Reading& reading) { return reading_.newest(reading); }
    [[nodiscard]] SensorWatch& watch() { return watch_; }

  private:
    std::unique_ptr<Sensor> device_;
    SensorWatch watch_;
    ServoReading reading_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::devices
