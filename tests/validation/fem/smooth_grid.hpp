// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/distance_grid.hpp"
#include "tests/validation/fem/friction_path.hpp"

namespace eti::fem {

/// A grid of distances, by cubics through its nodes (Catmull & Rom 1974) along each axis: no kinks between
/// cells, which Newton's method would not get over. Points beyond the last cells take the border's.
class SmoothGrid : public Solid {
  public:
    explicit SmoothGrid(const DistanceGrid& grid) : grid_(grid) {}
    [[nodiscard]] Sample sample(const Vec3d& point) const override;

  private:
    DistanceGrid grid_;
};

}  // namespace eti::fem
