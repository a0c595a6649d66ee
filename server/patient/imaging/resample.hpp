// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::imaging {

/// The geometry of the same voxels in a frame whose left, back and top are the columns of `axes`.
[[nodiscard]] Geometry reoriented(const Geometry& geometry, const Eigen::Matrix3d& axes);

/// Resamples a volume to an isotropic grid along LPS; `geometry` is the volume's own or that of reoriented().
/// Axes that already run along LPS, in any order or direction, are permuted without loss. Anything else
/// (oblique or sheared axes, anisotropic spacing) is interpolated by cubic convolution at the finest spacing,
/// or a coarser one that gives at most `most` voxels. Outside the volume is air (-1000 HU).
[[nodiscard]] Volume resample_upright(const Volume& volume, const Geometry& geometry, std::size_t most);
[[nodiscard]] inline Volume resample_upright(const Volume& volume, std::size_t most = std::size_t{1} << 26) {
    return resample_upright(volume, volume.geometry, most);
}

/// An isotropic grid along LPS, with the geometry's finest spacing, over all its voxels.
[[nodiscard]] Geometry upright_grid(const Geometry& geometry);

/// Marks the voxels of `grid` whose centres are in the volume.
[[nodiscard]] std::vector<std::uint8_t> covered(const Geometry& grid, const Geometry& volume);

/// Downsamples to voxels of `spacing` [m] along LPS: each is the mean of several linearly interpolated
/// samples where the volume is finer; NaN where the volume covers less than half of it.
[[nodiscard]] Volume downsampled(const Volume& volume, double spacing);

/// Resamples labels to another grid by nearest neighbour; 0 outside.
[[nodiscard]] Mask resample_labels(const Geometry& geometry, const Mask& labels);

}  // namespace eti::imaging
