// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>

#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"

namespace eti::bench {

/// Outcome and cost of one scripted intubation.
struct TrialResult {
    bool success = false;
    std::string reason;
    double glottic_opening_percent = 0.0;  ///< greatest
    double view_percent = 0.0;             ///< mean
    double gum_force = 0.0;                ///< [N], greatest
    double tongue_force = 0.0;             ///< [N], greatest
    double epiglottis_force = 0.0;         ///< [N], greatest
    double blade_force = 0.0;              ///< [N], of all tissue on the blade, greatest
    double time = 0.0;                     ///< [s]
    std::size_t particles = 0;
    double step_ms = 0.0;  ///< mean wall time of a step of the scene
};

/// Plays `script` on `scenario` to its end, at most two minutes of simulation time.
[[nodiscard]] TrialResult perform(const Scenario& scenario, const OperatorScript& script, std::uint64_t seed);

}  // namespace eti::bench
