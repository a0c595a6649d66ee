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

/// What a device reports: pose as its sensors give it, velocities as its driver estimates them, and what
/// a thumb does. A device without a pose leaves the pose alone.
struct Reading {
    Motion motion;
    std::uint32_t buttons = 0;             ///< of a tool as in ToolPose: bit 0 suction
    std::array<float, axis_count> axes{};  ///< each -1..1
    std::uint64_t sample = 0;              ///< counts the device's own measurements
    bool present = true;                   ///< false: nothing to go by; `motion` is what was known last
};

/// Whether all numbers are finite and the rotation is one.
[[nodiscard]] inline bool is_motion(const Motion& motion) {
    return is_rigid(motion.pose) && motion.velocity.allFinite() && motion.angular_velocity.allFinite();
}

/// What a device can give to the hand. Zero: nothing.
struct Abilities {
    float force = 0.0f;   ///< [N]
    float torque = 0.0f;  ///< [N m]
    float rate = 0.0f;    ///< [1/s], measurements that it should make; 0: as often as it is asked
};

/// What the servo thread of a device calls once in its period.
class ServoCycle {
  public:
    virtual ~ServoCycle() = default;
    virtual void servo_cycle() noexcept = 0;
};

/// Everything that a person holds: a pose, buttons, axes, and perhaps motors. The loop that owns it calls
/// look() and exchange() once a cycle, from one thread; neither may allocate, lock, throw or wait for
/// anything but the device itself. A device that goes away is not an error: it is not present until it is
/// back. Constructors throw DeviceError.
class Sensor {
  public:
    Sensor() = default;
    virtual ~Sensor() = default;
    Sensor(const Sensor&) = delete;
    Sensor& operator=(const Sensor&) = delete;

    /// What the person holding the device sees now. Only scripted hands and recordings need telling.
    virtual void look(const Observation&) {}

    /// Applies `wrench` (zero to a device without motors) and reads the device, `elapsed` [s] after
    /// the last call.
    [[nodiscard]] virtual Reading exchange(const Wrench& wrench, float elapsed) = 0;

    [[nodiscard]] virtual Abilities abilities() const { return {}; }

    /// A scripted hand or a recording has come to its end.
    [[nodiscard]] virtual bool finished() const { return false; }

    /// Hands the cycle to the device's own servo thread, until stop_servo(). False: it has none, and the
    /// caller runs the cycle itself.
    [[nodiscard]] virtual bool start_servo(ServoCycle&) { return false; }
    virtual void stop_servo() {}

    /// For libraries that insist on the program's first thread, which calls this every few milliseconds.
    virtual void tend() {}

    /// Why the device is not present, with the remedy; empty when nothing is known. From any thread but the
    /// loop's.
    [[nodiscard]] virtual std::string fault() const { return {}; }
};

}  // namespace eti::devices
