// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/model/runtime_parameters.hpp"
#include "common/model/tools/tools.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::bench {

/// The key moments of an attempt, in order.
inline constexpr std::array<std::string_view, 6> moment_names = {
    "rest",   // the first step
    "mouth",  // the blade passes the lips
    "touch",  // tissue touches the blade for the first time
    "best",   // best view of the glottis before the tube covers it
    "tube",   // the tube's tip passes the glottis, or is nearest to it
    "end"};

/// One of them, with the scene at that time.
struct KeyMoment {
    scene::Snapshot snapshot;
    float opening_percent = 0.0f;  ///< POGO
};

/// A scripted attempt and its recording.
struct Attempt {
    Scenario scenario;
    OperatorScript script;
    patient::Patient patient;
    Laryngoscope scope;
    RuntimeParameters start;  ///< runtime parameters as the session begins
    std::array<std::optional<KeyMoment>, moment_names.size()> moments;
    bool success = false;
    std::string reason;
};

/// Plays `script` on `scenario` to its end, at most two minutes of simulation time. A moment that did not
/// occur is missing: an operator who does not lift sees nothing.
[[nodiscard]] Attempt record_attempt(const Scenario& scenario, const OperatorScript& script);

}  // namespace eti::bench
