// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

/// Where the same voxels lie for one whose left, back and top are the columns of `axes`.
[[nodiscard]] Geometry seen_along(const Geometry& geometry, const Eigen::Matrix3d& axes);

/// The same volume on a grid whose axes run along LPS with equal spacing, where `geometry` is the volume's
/// own or that of seen_along(). Axes that already do, but in another order or direction, are turned without
/// loss; anything else (oblique or sheared axes, unequal spacing) is interpolated trilinearly at the finest
/// spacing, or a coarser one where the result would have more than `most` voxels. What lies outside the
/// volume becomes air (-1000 HU).
[[nodiscard]] Volume upright(const Volume& volume, const Geometry& geometry, std::size_t most);
[[nodiscard]] inline Volume upright(const Volume& volume, std::size_t most = std::size_t{1} << 26) {
    return upright(volume, volume.geometry, most);
}

/// A grid of equal spacing along LPS, the finest of the geometry's, over all its voxels.
[[nodiscard]] Geometry upright_grid(const Geometry& geometry);

/// Which voxels of `grid` have their centres in the volume.
[[nodiscard]] std::vector<std::uint8_t> covered(const Geometry& grid, const Geometry& volume);

/// The mean over voxels of `spacing` [m] along LPS, of several samples each where the volume's are finer; NaN
/// where the volume shows less than half of a voxel.
[[nodiscard]] Volume blocks(const Volume& volume, double spacing);

/// Labels on another grid: each voxel takes the label of the nearest voxel, 0 outside.
[[nodiscard]] Mask onto(const Geometry& geometry, const Mask& labels);

}  // namespace eti::imaging
