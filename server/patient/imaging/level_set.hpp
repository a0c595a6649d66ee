// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <span>

#include "common/mesh/distance_grid.hpp"

namespace eti::imaging {

struct LevelSetSettings {
    /// [m] b in the front's speed F - b curvature: bends of a radius below b are smoothed away. More
    /// withstands more noise and cuts off thin parts.
    float curvature = 0.2e-3f;
    int most_steps = 2000;  ///< a step moves the front by 0.4 voxels at most
    /// The front rests when fewer than this share of the inner voxels near it changed sides in five steps.
    float rest = 1e-3f;
};

/// Moves the zero set of `start` (a signed distance [m], negative inside) by
/// d phi / dt = -(F - b curvature) |grad phi| in a band of four voxels on either side (Osher & Sethian
/// 1988, J Comput Phys 79; narrow band: Adalsteinsson & Sethian 1995, J Comput Phys 118), upwind, until it
/// rests. `speed` holds F per node in [-1, 1], positive where the inside may grow. `progress` is called with
/// the number of steps done and may end the search by returning false; the front is then as far as it came.
[[nodiscard]] DistanceGrid evolve(
    DistanceGrid start, std::span<const float> speed, const LevelSetSettings& settings,
    const std::function<bool(int)>& progress = [](int) { return true; });

}  // namespace eti::imaging
