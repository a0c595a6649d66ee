// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"

namespace eti::panel {

/// A client's view of the network, in addition to the server's own report.
struct Connection {
    double state_age_mean_ms = 0.0, state_age_max_ms = 0.0;  ///< of deformation states, by the two
                                                             ///< machines' clocks
    std::uint64_t states = 0, states_missed = 0;             ///< received, and missed
    std::uint32_t sent = 0, accepted = 0, refused = 0;       ///< commands
    bool contested = false;                                  ///< a second server writes this session's
                                                             ///< status
    std::vector<std::string> programs;                       ///< programs in this session, with machine and
                                                             ///< process
};

struct HealthLine {
    std::string label, value;
    hud::Level level = hud::Level::neutral;
};

/// Health of devices, server and network, in that order. `silent_s`: time since the last status.
[[nodiscard]] std::vector<HealthLine> health_of(const view::SceneView& scene, const Connection& connection,
                                                double silent_s);

}  // namespace eti::panel
