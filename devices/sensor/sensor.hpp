// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "common/operator/hand.hpp"
#include "common/operator/operator.hpp"

namespace eti::devices {

/// What a device reports: pose as its sensors give it, velocities as its driver estimates them.
struct Reading {
    Motion motion;
    std::uint32_t buttons = 0;  ///< as in ToolPose: bit 0 suction
};

/// A device that a hand holds: a haptic arm with the laryngoscope, or a tracked tube. The loop that
/// owns it calls look() and exchange() once a cycle, from one thread; neither may allocate, lock,
/// throw or wait for anything but the device itself.
class Sensor {
  public:
    Sensor() = default;
    virtual ~Sensor() = default;
    Sensor(const Sensor&) = delete;
    Sensor& operator=(const Sensor&) = delete;

    /// What the person holding the device sees now. Only scripted hands need telling.
    virtual void look(const Observation&) {}

    /// Applies `wrench` (zero to a device without motors) and reads the device, `elapsed` [s] after
    /// the last call.
    [[nodiscard]] virtual Reading exchange(const Wrench& wrench, float elapsed) = 0;

    /// A scripted hand has come to the end of its track.
    [[nodiscard]] virtual bool finished() const { return false; }
};

}  // namespace eti::devices
