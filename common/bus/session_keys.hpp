// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/model/landmark.hpp"
#include "common/model/liquid_kind.hpp"
#include "common/model/live.hpp"
#include "common/model/parameters.hpp"
#include "common/model/tools.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// Puts this program's tables into a description: what lives, with its value at the `start`, parameters,
/// tissues.
void put_keys(const LiveValues& start, msg::SessionDescription& message);
void put_tools(const Laryngoscope& scope, const Tube& tube, msg::SessionDescription& message);

/// What lives, in the order of put_keys().
void put_live(const LiveValues& values, msg::LiveMetrics& message);
/// Parameters, in the order of put_keys().
[[nodiscard]] std::vector<double> to_msg(const Parameters& parameters);

/// Where a session's messages hold the values that this program knows by name. Server and reader may be of
/// different versions: what only one of them knows is left out, and unlike() names it.
class SessionKeys {
  public:
    /// Nothing, and `why`, when the description cannot be right: a value that is not finite, an impossible
    /// size, or a landmark that this program needs and the server does not have.
    [[nodiscard]] static std::optional<SessionKeys> of(const msg::SessionDescription& message,
                                                       std::string& why);

    /// [SI]; NaN for what the message does not hold.
    [[nodiscard]] LiveValues live(const msg::LiveMetrics& message) const;
    /// NaN for what `values` do not hold.
    [[nodiscard]] Parameters parameters(std::span<const double> values) const;
    /// [m]; nothing when one is missing or not finite.
    [[nodiscard]] std::optional<Landmarks> landmarks(const msg::LiveMetrics& message) const;

    /// [SI], what lives as the session begins; NaN for what the server does not have.
    [[nodiscard]] const LiveValues& start() const { return start_; }
    [[nodiscard]] const Landmarks& rest_landmarks() const { return rest_; }
    [[nodiscard]] const Laryngoscope& laryngoscope() const { return scope_; }
    [[nodiscard]] const Tube& tube() const { return tube_; }
    [[nodiscard]] LiquidKind liquid() const { return liquid_; }
    [[nodiscard]] double patient_weight() const { return weight_; }  ///< [kg]

    /// One line that names the keys that only one side knows, and both versions; empty where they agree.
    [[nodiscard]] const std::string& unlike() const { return unlike_; }

  private:
    // For each row of this program's table, the place in the message; npos: the server does not have it.
    std::vector<std::size_t> live_, parameters_, landmarks_;
    LiveValues start_;
    Landmarks rest_{};
    Laryngoscope scope_;
    Tube tube_;
    LiquidKind liquid_ = LiquidKind::saliva;
    double weight_ = 0.0;
    std::string unlike_;
};

}  // namespace eti::bus
