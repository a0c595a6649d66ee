// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <span>

#include "common/mesh/distance_grid.hpp"

namespace eti::imaging {

struct LevelSetSettings {
    /// [m], b in the front's speed F - b curvature: features of radius below b are smoothed away. A larger
    /// value suppresses more noise and cuts off thin parts.
    float curvature = 0.2e-3f;
    int max_steps = 2000;  ///< a step moves the front by at most 0.4 voxels
    /// The front has converged when fewer than this fraction of the inner voxels near it change sides in five
    /// steps.
    float rest = 1e-3f;
};

/// Evolves the zero level set of `start` (a signed distance [m], negative inside) by d phi / dt = -(F - b
/// curvature) |grad phi|, upwind, in a band of four voxels on either side, until it converges (Osher &
/// Sethian 1988, J Comput Phys 79; narrow band: Adalsteinsson & Sethian 1995, J Comput Phys 118). `speed`: F
/// per node in [-1, 1], positive where the inside may grow. `progress` is called with the number of steps
/// done; returning false ends the evolution early.
[[nodiscard]] DistanceGrid evolve(
    DistanceGrid start, std::span<const float> speed, const LevelSetSettings& settings,
    const std::function<bool(int)>& progress = [](int) { return true; });

}  // namespace eti::imaging
