// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/model/live.hpp"
#include "common/model/tools.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::bench {

/// The moments of an attempt that are looked at, in their order.
inline constexpr std::array<std::string_view, 6> moment_names = {
    "rest",   // the first step
    "mouth",  // the blade passes the lips
    "touch",  // tissue presses on it for the first time
    "best",   // most of the glottis is seen, before the tube covers it
    "tube",   // the tube's tip passes the glottis, or else is as near to it as ever
    "end"};

/// One of them: the scene as it was.
struct Moment {
    scene::Snapshot snapshot;
    float opening_percent = 0.0f;  ///< POGO
};

/// A scripted attempt and what is kept of it.
struct Attempt {
    Scenario scenario;
    OperatorScript script;
    anatomy::Patient patient;
    Laryngoscope scope;
    LiveValues start;  ///< what lives, as the session begins
    std::array<std::optional<Moment>, moment_names.size()> moments;
    bool success = false;
    std::string reason;
};

/// Plays `script` on `scenario` to its end, at most two minutes of simulation time. A moment that never came
/// is missing: an operator who does not lift sees nothing.
[[nodiscard]] Attempt perform_and_keep(const Scenario& scenario, const OperatorScript& script);

}  // namespace eti::bench
