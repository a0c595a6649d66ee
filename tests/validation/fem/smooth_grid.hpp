// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/distance_grid.hpp"
#include "tests/validation/fem/friction_path.hpp"

namespace eti::fem {

/// A distance grid with cubic interpolation through its nodes (Catmull & Rom 1974) along each axis: without
/// the kinks between cells, at which Newton's method fails. Points outside are clamped to the border cells.
class SmoothGrid : public Solid {
  public:
    explicit SmoothGrid(const DistanceGrid& grid) : grid_(grid) {}
    [[nodiscard]] Sample sample(const Vec3d& point) const override;

  private:
    DistanceGrid grid_;
};

}  // namespace eti::fem
