// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// How far a reported proxy is carried on.
struct PredictionBounds {
    /// [m] that the device may have moved since the pose the report answers to. Beyond it the report
    /// is about another device, or older than the stale limit: 1 m/s for 30 ms.
    float travel = 0.030f;
    float slowest_pace = 0.1f;    ///< below it a proxy is not taken to trail any farther
    float turning_time = 0.012f;  ///< [s] of angular velocity while in contact; two simulation steps
};

/// Where the proxy is now, from the last report and how the device has moved since: nullopt when
/// out of bounds.
///
/// A free proxy follows the device, so it is moved as the device moved; a report that is late by any
/// time within the bounds then drags nothing. In the simulation it may trail the device by up to a
/// step's motion, for it has mass; nothing holds it there, so that much of its distance is left out.
/// More than that is kept: a pressed proxy may lift off its contact for a step. A proxy in contact is held by
/// planes through its reported place, one per contact normal (the local model of Adachi, Kumano & Ogino,
/// VRAIS 1995): it slides along them and stays on them while the device is behind, so the wall acts at the
/// loop's rate and gives back no more than was put in. `age` [s]: since the report arrived, in simulation
/// time; `pace`: simulation seconds per second.
[[nodiscard]] std::optional<Motion> predicted_proxy(const Motion& device, const ProxyReport& report,
                                                    float age, float pace, const PredictionBounds& bounds);

}  // namespace eti::devices
