// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// Limits of the extrapolation of a reported proxy.
struct PredictionBounds {
    /// [m], maximum motion of the device since the pose that the report answers. A larger motion means
    /// another device or another place: no plane of an infant's mouth is larger.
    float travel = 0.030f;
    float min_real_time_factor = 0.1f;  ///< below it, the proxy's lag does not increase
    float turning_time = 0.012f;        ///< [s] of angular velocity while in contact; two simulation steps
    /// [s], time constant (1/e) of the memory of past speeds. It exceeds the delay of a late report (50 ms)
    /// plus the proxy's time to catch up (30 ms). What then remains of 0.2 m/s pulls with less than 0.1 N.
    float speed_memory = 0.1f;
    /// [s] without contact before a past speed counts. In a limit cycle, a pressed proxy repeatedly lifts off
    /// its contact for a step, and its offset must still be felt.
    float untouched_time = 0.25f;
};

struct Speeds {
    float moving = 0.0f;   ///< [m/s]
    float turning = 0.0f;  ///< [rad/s]
};

/// Recent speeds of a device in free air.
class RecentSpeeds {
  public:
    explicit RecentSpeeds(const PredictionBounds& bounds)
        : memory_(bounds.speed_memory), untouched_time_(bounds.untouched_time) {}

    /// `touching`: shell or tissue contact in the newest report. Returns zero speeds until there has been no
    /// contact for long enough.
    Speeds update(const Motion& device, bool touching, float dt);

  private:
    float memory_, untouched_time_;  // [s]
    Speeds recent_;
    float untouched_ = 0.0f;  // [s]
};

/// Current proxy motion, predicted from the last report and the device's motion since; nullopt when out of
/// bounds.
///
/// A free proxy follows the device, so it is moved as the device moved; a report of any delay within the
/// bounds then causes no drag. In the simulation the proxy has mass and may lag the device by up to one
/// step's motion without any contact, so that much of its offset is ignored. A larger offset is kept: a
/// pressed proxy may lift off its contact for a step. A report describes the past, when a device that has
/// stopped since was still moving. The step's motion is therefore based on the larger of its current speed
/// and `lately`, so that a stop in free air causes no pull.
///
/// A proxy in contact is constrained by planes through its reported position, one per contact normal (the
/// local model of Adachi, Kumano & Ogino, VRAIS 1995). It slides along them and stays on them while the
/// device is behind. The wall thus responds at the loop's rate and returns no more energy than it absorbed.
/// `age` [s]: since the report arrived, in simulation time; `pace`: simulation seconds per second.
///
/// `held`: messages are missing; the reported state is frozen and only resists. Rotation is constrained like
/// translation, about the axes that turn the contacts' centre into the planes. The offset from the device
/// that the planes do not explain shrinks as the device moves along it. It thus pushes the device to the
/// reported position and no farther.
[[nodiscard]] std::optional<Motion> predicted_proxy(const Motion& device, const ProxyReport& report,
                                                    float age, float pace, const PredictionBounds& bounds,
                                                    const Speeds& lately = {}, bool held = false);

}  // namespace eti::devices
