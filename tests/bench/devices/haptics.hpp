// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::bench {

struct HapticsOptions {
    std::filesystem::path out = "out/bench";
    bool quick = false;        ///< a corner of the maps, no live runs
    double live_seconds = 60;  ///< of each live run
};

/// Largest stable stiffness over delay and loss with and without the passivity controller; rendered against
/// set stiffness; from touch to force; the real loop beside the real server; the device's force laws
/// against finite elements. Writes haptics-*.csv. Returns the program's exit code.
[[nodiscard]] int haptics(const HapticsOptions& options);

}  // namespace eti::bench
