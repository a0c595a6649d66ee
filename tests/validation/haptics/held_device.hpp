// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/hand.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::validation {

/// The device's actuators.
enum class Motors : std::uint8_t {
    six,    ///< force and torque
    three,  ///< a force at its gimbal, 60 mm up the handle, whose joints turn freely
};

/// A device in a hand, which pulls it towards wanted().
class HeldDevice : public devices::Sensor {
  public:
    static inline const Vec3f gimbal{0.0f, 0.06f, 0.0f};  ///< [m], tool frame

    HeldDevice(Motors motors, const HandSettings& settings, const RigidTransform& start)
        : motors_(motors), hand_(settings, start) {}

    devices::Reading exchange(const Wrench& wrench, float elapsed) final {
        if (elapsed > 0.0f) {
            const Vec3f arm = hand_.motion().pose.rotation * gimbal;
            hand_.step(wanted(),
                       motors_ == Motors::three ? Wrench{wrench.force, arm.cross(wrench.force)} : wrench,
                       elapsed);
        }
        devices::Reading reading;
        reading.motion = hand_.motion();
        reading.motion.pose = hand_.reported();
        reading.sample = ++sample_;
        return reading;
    }

  protected:
    /// The hand's aim in this cycle.
    [[nodiscard]] virtual RigidTransform wanted() = 0;
    [[nodiscard]] const RigidTransform& pose() const { return hand_.motion().pose; }

  private:
    Motors motors_;
    HandDevice hand_;
    std::uint64_t sample_ = 0;
};

}  // namespace eti::validation
