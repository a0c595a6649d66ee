// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// How far a reported proxy is carried on.
struct PredictionBounds {
    /// [m] that the device may have moved since the pose the report answers to. Beyond it the report
    /// is about another device, or about another place: no plane of an infant's mouth is larger.
    float travel = 0.030f;
    float slowest_pace = 0.1f;    ///< below it a proxy is not taken to trail any farther
    float turning_time = 0.012f;  ///< [s] of angular velocity while in contact; two simulation steps
    /// [s], after which a speed that the device once had counts for 1/e. Longer than a late report is under
    /// way (50 ms) and the proxy then takes to catch up (30 ms); what is left of 0.2 m/s after that pulls
    /// with less than 0.1 N.
    float speed_memory = 0.1f;
    /// [s] that nothing must have been touched for before an old speed counts. While a limit cycle lasts, a
    /// pressed proxy lifts off its contact for a step again and again, and what holds it is felt.
    float untouched_time = 0.25f;
};

struct Speeds {
    float moving = 0.0f;   ///< [m/s]
    float turning = 0.0f;  ///< [rad/s]
};

/// How fast a device in free air has lately been.
class RecentSpeeds {
  public:
    explicit RecentSpeeds(const PredictionBounds& bounds)
        : memory_(bounds.speed_memory), untouched_time_(bounds.untouched_time) {}

    /// `touching`: by the newest report, shell or tissue. Returns no speed until nothing has been touched for
    /// long enough.
    Speeds update(const Motion& device, bool touching, float dt);

  private:
    float memory_, untouched_time_;  // [s]
    Speeds recent_;
    float untouched_ = 0.0f;  // [s]
};

/// Where the proxy is now, from the last report and how the device has moved since: nullopt when
/// out of bounds.
///
/// A free proxy follows the device, so it is moved as the device moved; a report that is late by any
/// time within the bounds then drags nothing. In the simulation it may trail the device by up to a
/// step's motion, for it has mass; nothing holds it there, so that much of its distance is left out.
/// More than that is kept: a pressed proxy may lift off its contact for a step. A report is about a while
/// ago, when a device that has stopped since was still moving: the step's motion is by the faster of its
/// present speed and `lately`, so that a stop in free air is not pulled on. A proxy in contact is held by
/// planes through its reported place, one per contact normal (the local model of Adachi, Kumano & Ogino,
/// VRAIS 1995): it slides along them and stays on them while the device is behind, so the wall acts at the
/// loop's rate and gives back no more than was put in. `age` [s]: since the report arrived, in simulation
/// time; `pace`: simulation seconds per second.
///
/// `held`: messages are missing, and what the report tells stands still and only resists. Turning is held
/// as places are, by what turns the contacts' centre into the planes. What held the proxy off the device
/// besides the planes is used up by as much as the device goes along it, so that it pushes to where it was
/// reported and not on and on.
[[nodiscard]] std::optional<Motion> predicted_proxy(const Motion& device, const ProxyReport& report,
                                                    float age, float pace, const PredictionBounds& bounds,
                                                    const Speeds& lately = {}, bool held = false);

}  // namespace eti::devices
