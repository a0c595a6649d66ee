// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/mesh/distance_grid.hpp"
#include "server/pbd/fluid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// A distance grid of two nodes or more along each axis, as the fluid reads it: distance and gradient at
/// once, what DistanceGrid::sample gives but for rounding, at a third of its cost. The grid has to last.
class FluidSolid {
  public:
    struct Sample {
        float distance;  ///< [m]
        Vec3f gradient;  ///< [m], by a cell's width
        /// Unit.
        [[nodiscard]] Vec3f normal() const {
            const float squared = gradient.squaredNorm();
            // On a ridge of the distance the gradient vanishes; any direction is then as good as another.
            return squared > 1e-20f ? Vec3f(gradient * (1.0f / std::sqrt(squared))) : Vec3f(Vec3f::UnitZ());
        }
    };

    explicit FluidSolid(const DistanceGrid& grid);
    /// Points outside the grid take the nearest border value.
    [[nodiscard]] Sample at(const Vec3f& point) const;

    [[nodiscard]] float spacing() const { return 1.0f / per_spacing_; }

  private:
    using Whole = std::int32_t __attribute__((vector_size(16)));

    const float* value_;
    Four origin_;
    float per_spacing_;
    Four last_;  ///< nodes
    Whole last_cell_;
    std::ptrdiff_t row_, layer_;
};

/// Not longer than `limit`.
[[nodiscard]] inline Vec3f limited(const Vec3f& v, float limit) {
    const float squared = v.squaredNorm();
    return squared > limit * limit ? Vec3f(v * (limit / std::sqrt(squared))) : v;
}

[[nodiscard]] inline std::optional<FluidSolid> solid_of(const FluidSurroundings& surroundings) {
    return surroundings.solid != nullptr ? std::optional<FluidSolid>(*surroundings.solid) : std::nullopt;
}

}  // namespace eti::pbd
