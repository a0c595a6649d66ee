// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "devices/sensor/sensor_watch.hpp"
#include "devices/sensor/triple_buffer.hpp"

namespace eti::devices {

/// Reads a device without forces, in its servo thread or in one of our own at 250 Hz, for programs that only
/// want to know where it is.
class Sampling final : private ServoCycle {
  public:
    explicit Sampling(std::unique_ptr<Sensor> device);
    ~Sampling() override;

    /// The newest reading; true when it was not read before.
    [[nodiscard]] bool newest(Reading& reading);
    [[nodiscard]] SensorWatch& watch() { return watch_; }

  private:
    void servo_cycle() noexcept override;

    std::unique_ptr<Sensor> device_;
    SensorWatch watch_;
    TripleBuffer<Reading> newest_;
    std::int64_t last_ = 0;
    bool on_servo_ = false;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::devices
