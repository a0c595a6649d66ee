// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

/// The same volume on a grid whose axes run along LPS with equal spacing. Axes that already do, but in
/// another order or direction, are turned without loss; anything else (oblique or sheared axes, unequal
/// spacing) is interpolated trilinearly at the finest spacing, or a coarser one where the result would
/// have more than `most` voxels. What lies outside the volume becomes air (-1000 HU).
[[nodiscard]] Volume upright(const Volume& volume, std::size_t most = std::size_t{1} << 26);

/// Labels on another grid: each voxel takes the label of the nearest voxel, 0 outside.
[[nodiscard]] Mask onto(const Geometry& geometry, const Mask& labels);

}  // namespace eti::imaging
