// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

/// Labels of an interpolated volume, brought back to the grid of `volume`, whose position in the labels'
/// frame is `own`. Interpolation moves borders by up to half a voxel in each direction. Therefore a voxel's
/// own grey value decides between air, soft tissue and bone: it gets the nearest label of that kind among the
/// 27 around it, or the nearest label if none of them is of that kind. Pieces of bone that are then smaller
/// than settings.smallest_bone become soft tissue. Grids with the same voxels keep their labels.
[[nodiscard]] imaging::Mask labels_on_own_grid(const imaging::Volume& volume, const imaging::Geometry& own,
                                               const imaging::Mask& labels, const SegmentSettings& settings);

}  // namespace eti::segmentation
