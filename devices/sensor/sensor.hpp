// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "common/device/coupling.hpp"
#include "common/operator/operator.hpp"

namespace eti::devices {

inline constexpr std::size_t axis_count = 8;

/// A device's reading: pose from its sensors, velocities as estimated by its driver, buttons and axes. A
/// device without a pose leaves the pose unchanged.
struct Reading {
    Motion motion;
    std::uint32_t buttons = 0;             ///< of a tool as in ToolPose: bit 0 suction
    std::array<float, axis_count> axes{};  ///< each -1..1
    std::uint64_t sample = 0;              ///< counts the device's own measurements
    bool present = true;                   ///< false: no valid data; `motion` is the last known one
};

/// Whether all numbers are finite and the rotation is valid.
[[nodiscard]] inline bool is_motion(const Motion& motion) {
    return is_valid_pose(motion.pose) && motion.velocity.allFinite() && motion.angular_velocity.allFinite();
}

/// Output range of a device. Zero: none.
struct DeviceCapabilities {
    float force = 0.0f;   ///< [N]
    float torque = 0.0f;  ///< [N m]
    float rate = 0.0f;    ///< [1/s], nominal measurement rate; 0: one per request
};

/// Callback that a device's servo thread runs once per period.
class ServoCycle {
  public:
    virtual ~ServoCycle() = default;
    virtual void servo_cycle() noexcept = 0;
};

/// A device held by a person: a pose, buttons, axes, and possibly motors. The loop that owns it calls
/// observe() and exchange() once per cycle, from one thread; neither may allocate, lock, throw or wait for
/// anything but the device itself. A lost device is not an error: its readings are not present until it is
/// back. Constructors throw DeviceError.
class Sensor {
  public:
    Sensor() = default;
    virtual ~Sensor() = default;
    Sensor(const Sensor&) = delete;
    Sensor& operator=(const Sensor&) = delete;

    /// What the operator sees now. Only scripted hands and recordings use it.
    virtual void observe(const Observation&) {}

    /// Applies `wrench` (zero to a device without motors) and reads the device, `elapsed` [s] after the last
    /// call.
    [[nodiscard]] virtual Reading exchange(const Wrench& wrench, float elapsed) = 0;

    [[nodiscard]] virtual DeviceCapabilities capabilities() const { return {}; }

    /// A scripted hand or a recording has ended.
    [[nodiscard]] virtual bool finished() const { return false; }

    /// Runs the cycle on the device's own servo thread until stop_servo(). False: it has none, and the caller
    /// runs the cycle itself.
    [[nodiscard]] virtual bool start_servo(ServoCycle&) { return false; }
    virtual void stop_servo() {}

    /// For libraries that require the program's main thread, which calls this every few milliseconds.
    virtual void poll_events() {}

    /// Why the device is not present, with the remedy; empty if unknown. Call from any thread but the loop's.
    [[nodiscard]] virtual std::string fault() const { return {}; }
};

}  // namespace eti::devices
