// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"

namespace eti::panel {

/// What a client knows of the network, beside what the server says of itself.
struct Connection {
    double state_age_mean_ms = 0.0, state_age_max_ms = 0.0;  ///< of shapes, as the two clocks tell it
    std::uint64_t states = 0, states_missed = 0;             ///< that came, and that never did
    std::uint32_t sent = 0, accepted = 0, refused = 0;       ///< commands
    bool contested = false;                                  ///< a second server writes this session's status
    std::vector<std::string> programs;                       ///< on this session, with machine and process
};

struct HealthLine {
    std::string label, value;
    hud::Level level = hud::Level::neutral;
};

/// Devices', server's and network's, one below the other. `silent_s`: since a status came last.
[[nodiscard]] std::vector<HealthLine> health_of(const view::SceneView& scene, const Connection& connection,
                                                double silent_s);

}  // namespace eti::panel
