// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

struct SegmentSettings;

/// Pose of the head in a volume, from the image alone, regardless of the file's directions.
struct HeadFrame {
    /// Columns: the head's left, back and top, right-handed, in the volume's frame.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Vec3d centre = Vec3d::Zero();  ///< [m], of the cranium of the fitted head
    double size = 0.0;             ///< [m], radius of the largest ball in that cranium: 36 mm at term
    bool vault = true;             ///< whether the volume shows a cranium
    double asymmetry =
        0.0;              ///< mean distance to the mirrored other half over the largest one counted: 0 to 1
    double misfit = 0.0;  ///< the same distance, from the fitted head

    /// Rotation of the head from the file's directions [rad].
    [[nodiscard]] double turn() const;
};

/// Finds the head's frame in any orientation:
/// - the cranium: the largest ball of soft tissue with bone on most sides;
/// - the mirror plane through it (or through the inner air where the volume shows no vault) in which bone,
///   inner air and skin agree best with their mirror images;
/// - the tilt within that plane at which a newborn's bones, air and skin fit the volume's best.
/// Left and right are indistinguishable: for a mirrored volume the frame is that of the mirrored head. Throws
/// VolumeError, starting with "the volume", if there is no head.
[[nodiscard]] HeadFrame find_head(const imaging::Volume& volume, const SegmentSettings& settings);

}  // namespace eti::segmentation
