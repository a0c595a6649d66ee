// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/mesh/distance_grid.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// Fast reader of a distance grid with at least two nodes per axis: distance and gradient at once, equal to
/// DistanceGrid::sample() up to rounding, at a third of its cost. The grid must outlive it.
class FluidSolid {
  public:
    struct Sample {
        float distance;  ///< [m]
        Vec3f gradient;  ///< [m], per cell width
        /// Unit normal.
        [[nodiscard]] Vec3f normal() const {
            const float squared = gradient.squaredNorm();
            // On a ridge of the distance the gradient vanishes; any direction will do.
            return squared > 1e-20f ? Vec3f(gradient * (1.0f / std::sqrt(squared))) : Vec3f(Vec3f::UnitZ());
        }
    };

    explicit FluidSolid(const DistanceGrid& grid);
    /// Points outside the grid are clamped to its border.
    [[nodiscard]] Sample at(const Vec3f& point) const;

    [[nodiscard]] float spacing() const { return 1.0f / per_spacing_; }

  private:
    using Whole = std::int32_t __attribute__((vector_size(16)));

    const float* value_;
    Float4 origin_;
    float per_spacing_;
    Float4 last_;  ///< nodes
    Whole last_cell_;
    std::ptrdiff_t row_, layer_;
};

/// `v` clamped to length `limit`.
[[nodiscard]] inline Vec3f clamped_to_length(const Vec3f& v, float limit) {
    const float squared = v.squaredNorm();
    return squared > limit * limit ? Vec3f(v * (limit / std::sqrt(squared))) : v;
}

[[nodiscard]] inline std::optional<FluidSolid> solid_of(const FluidSurroundings& surroundings) {
    return surroundings.solid != nullptr ? std::optional<FluidSolid>(*surroundings.solid) : std::nullopt;
}

}  // namespace eti::pbd
