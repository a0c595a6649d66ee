// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/labels.hpp"

namespace eti::segmentation {

/// Agreement of two segmentations on one structure.
struct Agreement {
    double dice = 0.0;  ///< 2 |A and B| / (|A| + |B|)
    /// [voxels], over the surface voxels of both; empty if only one of them has the structure.
    std::optional<double> mean_surface_distance;
    std::size_t voxels_found = 0;
    std::size_t voxels_true = 0;
};

/// The structure is the union of `labels` (bone: bone, mandible, spine). Throws VolumeError unless both masks
/// have the same geometry.
[[nodiscard]] Agreement agreement(const imaging::Mask& found, const imaging::Mask& truth,
                                  const std::vector<Label>& labels);

}  // namespace eti::segmentation
