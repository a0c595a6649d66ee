// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "client/view/liquid/spatial_hash.hpp"

namespace eti::view {

/// Distinguishes drops from bulk liquid by each particle's neighbour density.
class NeighbourDensity {
  public:
    void count(std::span<const Vec3f> positions, float spacing);  ///< [m]

    /// By particle: approximate number of neighbours within `spacing`; weights decrease to zero at one and
    /// a half spacings, so that the value is continuous.
    [[nodiscard]] std::span<const float> densities() const { return densities_; }

  private:
    SpatialHash cells_;
    std::vector<float> densities_;
};

}  // namespace eti::view
