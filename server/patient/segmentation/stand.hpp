// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "server/patient/segmentation/place_points.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

/// How a volume is cut into labels: along its own grid, so that nothing is interpolated, with seeds placed in
/// the head's directions.
struct Stand {
    /// The grid's axes, in the order and with the signs that come nearest to the head's left, back and top.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    /// The head's directions in those axes; identity where they lie within 5 degrees.
    Eigen::Matrix3d lean = Eigen::Matrix3d::Identity();
    HeadPlace place;    ///< in the head's directions
    double turn = 0.0;  ///< [rad], of the head from the file's directions
};

/// Finds the head. One turned by more than 45 degrees from the file's directions is a contradiction. Without
/// a head, and with all five kinds of points given, directions are the file's. Throws VolumeError of
/// find_head().
[[nodiscard]] Stand stand_up(const imaging::Volume& volume, const Points& given,
                             const SegmentSettings& settings, std::vector<std::string>& contradictions);

/// Points as seen in directions that are turned: each multiplied by `turn`.
[[nodiscard]] Points turned(Points points, const Eigen::Matrix3d& turn);

}  // namespace eti::segmentation
