// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

namespace eti::bench {

struct SpeedOptions {
    bool json = false;
    bool sweeps = false;                ///< only the scene while posture and tissue change
    bool quick = false;                 ///< fewer repetitions and no large bodies, for tests
    std::vector<int> threads = {1, 2};  ///< numbers of threads to measure with
};

/// Cost of the solver's parts with each number of threads, beside the memory bound of the same run. Prints a
/// table (Markdown) or one JSON object. Returns the program's exit code.
[[nodiscard]] int speed(const SpeedOptions& options);

}  // namespace eti::bench
