// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::bench {

struct HapticsOptions {
    std::filesystem::path out = "out/bench";
    bool quick = false;        ///< a corner of the maps, no live runs
    double live_seconds = 60;  ///< of the run beside a server
    bool whole_grid = false;   ///< every cell of the grid over the bus, not a corner of it
    double grid_minutes = 10;  ///< time limit of the grid
    std::string only;          ///< one of the tables by name; empty: all
};

/// Valid values of `only`.
[[nodiscard]] std::vector<std::string> haptics_table_names();

/// Largest stable stiffness over delay and loss with and without the passivity controller; effect of gaps
/// between messages on a pressing hand; rendered against set stiffness; latency from touch to force. Also the
/// real loop with the real server over DDS, pressing on a wall through delay, jitter and loss, and in an
/// attempt; the device's force laws against finite elements. Writes haptics-*.csv. Returns the program's exit
/// code.
[[nodiscard]] int haptics(const HapticsOptions& options);

}  // namespace eti::bench
