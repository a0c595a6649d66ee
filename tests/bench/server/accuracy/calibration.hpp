// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::bench {

struct CalibrationOptions {
    std::filesystem::path out = "out/bench";
    bool quick = false;  ///< a corner of the sweep, for tests
};

/// Effective modulus and Poisson ratio of bodies of overlapping clusters against the input modulus: bars
/// under traction, and blocks under the sphere and the blade. Writes calibration.csv. Returns the program's
/// exit code.
[[nodiscard]] int calibration(const CalibrationOptions& options);

}  // namespace eti::bench
