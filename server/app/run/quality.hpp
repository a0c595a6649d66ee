// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <string_view>

#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::app {

/// How finely time is divided for the tissue around the tongue, and for the tube.
enum class Quality {
    automatic,  ///< in a session that follows the clock: the finest that this machine can run in real time
    full,       ///< as the scenario says
    reduced     ///< half the substeps
};

/// In the order of Quality.
inline constexpr std::array<std::string_view, 3> quality_names = {"auto", "full", "reduced"};

[[nodiscard]] inline std::string_view name_of(Quality quality) {
    return quality_names.at(static_cast<std::size_t>(quality));
}

/// The scenario at reduced quality: half the substeps, also in its text. Larger particles save more, but hide
/// the premature newborn's glottis. What it costs and changes: docs/solver/cost.md,
/// docs/solver/sufficiency.md.
[[nodiscard]] Scenario reduced(const Scenario& scenario);

/// Whether a machine on which a step costs this [s], with all tissue awake and the tools at rest, keeps real
/// time while the blade lifts the tongue.
[[nodiscard]] bool keeps_real_time(double awake_step_cost);

/// Full if this machine keeps real time with it, else reduced. It simulates steps of this patient, at most
/// some tens, until one is fast enough: other programs disturb single steps. Logs the result.
[[nodiscard]] Quality finest_in_real_time(const Scenario& scenario, const patient::Patient& patient);

}  // namespace eti::app
