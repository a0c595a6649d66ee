// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "tests/bench/server/accuracy/block_body.hpp"

namespace eti::bench {

/// A block under one load, beside the solution of independent finite elements (docs/solver/references.md).
struct BlockLoad {
    double depth_mm = 0.0;   ///< of the indenter; 0 for the bar
    double value = 0.0;      ///< force [N], or the bar's sag [mm]; not finite if the body diverged
    double reference = 0.0;  ///< the same
    /// Of displacements, relative, RMS over points of the top; NaN where the reference has none.
    double shape_error = std::numeric_limits<double>::quiet_NaN();
    int steps = 0;  ///< until at rest
};

struct BlockOutcome {
    std::vector<BlockLoad> loads;
    double frame_ms = 0.0;  ///< wall time per simulated 1/90 s
    std::size_t particles = 0;
};

inline constexpr std::string_view block_cases[] = {"bar", "sphere", "blade"};

/// Runs a case of `block_cases`: a bar under its own weight, a sphere or a blade pressed into a block by and
/// by. The reference's modulus replaces that of `setting`; its Poisson's ratio is that of `setting`. Throws
/// when the reference cannot be read or lacks the ratio.
[[nodiscard]] BlockOutcome run_block(std::string_view name, BodySettings setting);

}  // namespace eti::bench
