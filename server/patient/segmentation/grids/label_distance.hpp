// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/patient/imaging/filter.hpp"
#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Mask of the voxels with one of the labels.
[[nodiscard]] imaging::Bits select(const imaging::Mask& labels, const std::vector<Label>& which);

/// Corners [m] of a box along LPS.
struct Box {
    Vec3d low = Vec3d::Constant(1e9), high = Vec3d::Constant(-1e9);
    void add(const Vec3d& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
};

/// Labels on an isotropic grid along LPS with a spacing of at least `finest` [m]; restricted to `part`, if
/// given.
[[nodiscard]] imaging::Mask upright_labels(const imaging::Mask& labels, double finest,
                                           const Box* part = nullptr);

/// Signed distances [m] to a structure's surface, negative inside, in the volume's frame. The surface is the
/// half-level set of the mask blurred by 0.8 voxels. Distances are exact near it; farther away they are
/// propagated from voxel to voxel. The grid must be isotropic and along LPS.
[[nodiscard]] DistanceGrid distance_of(const imaging::Geometry& geometry, const imaging::Bits& member);

}  // namespace eti::segmentation
