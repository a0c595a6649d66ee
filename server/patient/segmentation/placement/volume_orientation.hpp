// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "server/patient/segmentation/placement/place_seeds.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

/// Orientation for segmenting a volume: on its own grid, so that nothing is interpolated, with seeds placed
/// in the head's directions.
struct VolumeOrientation {
    /// The grid's axes, permuted and signed to be closest to the head's left, back and top.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    /// The head's directions in those axes; identity if within 5 degrees.
    Eigen::Matrix3d residual_rotation = Eigen::Matrix3d::Identity();
    HeadPose place;     ///< in the head's directions
    double turn = 0.0;  ///< [rad], rotation of the head from the file's directions
};

/// Finds the head. A rotation of more than 45 degrees from the file's directions is reported as a
/// contradiction. Without a head, but with all five kinds of points given, the directions are the file's.
/// Throws VolumeError of find_head().
[[nodiscard]] VolumeOrientation orient_volume(const imaging::Volume& volume, const Points& given,
                                              const SegmentSettings& settings,
                                              std::vector<std::string>& contradictions);

/// Points rotated by `turn`.
[[nodiscard]] Points turned(Points points, const Eigen::Matrix3d& turn);

}  // namespace eti::segmentation
