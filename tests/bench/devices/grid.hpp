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

/// What came of a cell; all of it is told, also of cells that do not count.
struct GridOutcome {
    std::string not_measured;  ///< why the cell tells nothing; empty: it does
    double excursion = 0.0;    ///< [m], as validation::LoopOutcome::excursion
    double force = 0.0;        ///< [N], mean while it was watched
    double faded = 0.0;        ///< share of the cell's cycles with less than all force for want of messages
    double server_lag = 0.0;   ///< [s/s], by which the server fell behind the clock
    double message_p99 = 0.0, message_max = 0.0;  ///< [s], from one message to the next
    double relay_late = 0.0;                      ///< [s], most that a message was held up beyond its delay
    [[nodiscard]] bool stable() const { return excursion <= validation::most_excursion; }
};

/// Bounds beyond which a cell was not what it says.
inline constexpr double most_server_lag = 0.05;  ///< [s/s]
inline constexpr double most_relay_late = 5e-3;  ///< [s]
inline constexpr double most_faded = 0.25;       ///< share: a device without force holds still on any wall
inline constexpr double least_force = 0.2;       ///< [N]

struct GridPlan {
    bool whole = false;     ///< all delays, losses and stiffnesses, with and without the controller
    double minutes = 10.0;  ///< after which no further cell is begun
};

/// The real haptic loop in real time with a simulated device in a light grip, against the real server as a
/// process of its own over DDS, through a relay with delay, jitter and loss. The blade is pressed 4 mm into
/// the bridge of the patient's nose, where the server's shell is a wall, bumped, and held. From the shipped
/// stiffness upwards in doublings until one is not stable. `done` is called for each cell at the end. Throws
/// std::runtime_error when there is no server.
void run_grid(const GridPlan& plan, const std::function<void(const GridCell&, const GridOutcome&)>& done);

}  // namespace eti::bench
