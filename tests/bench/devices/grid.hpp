// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <string>

#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::bench {

using validation::Channel;

/// One stiffness of the wall at one delay and loss.
struct GridCell {
    bool passivity = true;
    Channel channel;
    float stiffness = 0.0f;  ///< [N/m], of the coupling
};

/// Outcome of a cell; reported completely, also for cells that do not count.
struct GridOutcome {
    std::string not_measured;  ///< why the cell is not valid; empty: it is
    double excursion = 0.0;    ///< [m], as validation::LoopOutcome::excursion
    double force = 0.0;        ///< [N], mean during the observation
    double faded = 0.0;        ///< share of the cell's cycles with reduced force because messages are missing
    double server_lag = 0.0;   ///< [s/s], rate at which the server fell behind the clock
    double message_p99 = 0.0, message_max = 0.0;  ///< [s], between consecutive messages
    double relay_late = 0.0;                      ///< [s], maximum relay lateness beyond the set delay
    [[nodiscard]] bool stable() const { return excursion <= validation::most_excursion; }
};

/// Bounds beyond which a cell is not valid.
inline constexpr double most_server_lag = 0.05;  ///< [s/s]
inline constexpr double most_relay_late = 5e-3;  ///< [s]
inline constexpr double most_faded = 0.25;       ///< share: a device without force holds still on any wall
inline constexpr double least_force = 0.2;       ///< [N]

struct GridPlan {
    bool whole = false;     ///< all delays, losses and stiffnesses, with and without the controller
    double minutes = 10.0;  ///< no cell is started after this time
};

/// The real haptic loop in real time with a simulated device in a light grip, against the real server in a
/// process of its own over DDS, through a relay with delay, jitter and loss. The blade is pressed 4 mm into
/// the bridge of the patient's nose, where the server's shell is a wall, bumped, and held. The stiffness
/// doubles from the shipped value until one is unstable. `done` is called at the end of each cell. Throws
/// std::runtime_error when there is no server.
void run_grid(const GridPlan& plan, const std::function<void(const GridCell&, const GridOutcome&)>& done);

}  // namespace eti::bench
