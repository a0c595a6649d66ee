// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/model/attempt_metrics.hpp"
#include "common/model/landmark.hpp"
#include "common/model/liquid_kind.hpp"
#include "common/model/live_measures.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/tools/tools.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// Adds this program's tables to a description: runtime parameters with their values at the `start`, metrics,
/// live measures and tissues.
void set_keys(const RuntimeParameters& start, msg::SessionDescription& message);
void set_tools(const Laryngoscope& scope, const Tube& tube, msg::SessionDescription& message);

/// Runtime parameters, in the order of set_keys().
void set_runtime_parameters(const RuntimeParameters& values, msg::LiveMetrics& message);
/// Live measures, in the order of set_keys().
void set_measures(const LiveMeasures& measures, msg::LiveMetrics& message);
/// Metrics, in the order of set_keys().
[[nodiscard]] std::vector<double> to_msg(const AttemptMetrics& metrics);

/// Indices of named values in a session's messages. Server and reader may have different versions: names that
/// only one of them has are left out, and key_mismatch() lists them.
class SessionKeys {
  public:
    /// Returns nullopt and sets `why` for an invalid description: a value that is not finite, an impossible
    /// size, or a missing landmark that this program needs.
    [[nodiscard]] static std::optional<SessionKeys> of(const msg::SessionDescription& message,
                                                       std::string& why);

    /// [SI]; NaN for values that the message does not contain.
    [[nodiscard]] RuntimeParameters runtime_parameters(const msg::LiveMetrics& message) const;
    /// NaN for measures that the message does not contain.
    [[nodiscard]] LiveMeasures measures(const msg::LiveMetrics& message) const;
    /// NaN for metrics that `values` does not contain.
    [[nodiscard]] AttemptMetrics metrics(std::span<const double> values) const;
    /// [m]; nullopt when one is missing or not finite.
    [[nodiscard]] std::optional<Landmarks> landmarks(const msg::LiveMetrics& message) const;

    /// [SI], runtime parameters at the start of the session; NaN for those the server does not have.
    [[nodiscard]] const RuntimeParameters& start() const { return start_; }
    [[nodiscard]] const Landmarks& rest_landmarks() const { return rest_; }
    [[nodiscard]] const Laryngoscope& laryngoscope() const { return scope_; }
    [[nodiscard]] const Tube& tube() const { return tube_; }
    [[nodiscard]] LiquidKind liquid() const { return liquid_; }
    [[nodiscard]] double patient_weight() const { return weight_; }  ///< [kg]

    /// One line with the keys that only one side has, and both versions; empty where they agree.
    [[nodiscard]] const std::string& key_mismatch() const { return key_mismatch_; }

  private:
    // For each row of this program's table, its index in the message; npos: the server does not have it.
    std::vector<std::size_t> runtime_parameters_, metrics_, measures_, landmarks_;
    RuntimeParameters start_;
    Landmarks rest_{};
    Laryngoscope scope_;
    Tube tube_;
    LiquidKind liquid_ = LiquidKind::saliva;
    double weight_ = 0.0;
    std::string key_mismatch_;
};

}  // namespace eti::bus
