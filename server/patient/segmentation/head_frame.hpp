// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

struct SegmentSettings;

/// How the head lies in a volume, as the picture shows it, whatever the file says of its directions.
struct HeadFrame {
    /// Columns: the head's left, back and top, right-handed, in the volume's frame.
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Vec3d centre = Vec3d::Zero();  ///< [m], of the cranium of the head that was laid into the volume
    double size = 0.0;             ///< [m], radius of the largest ball in that cranium: 36 mm at term
    bool vault = true;             ///< whether the volume shows a cranium
    double asymmetry =
        0.0;              ///< mean distance to the mirrored other half, of the farthest that counts: 0 to 1
    double misfit = 0.0;  ///< the same distance from the head that was laid into the volume

    /// How far the head is turned from the file's directions [rad].
    [[nodiscard]] double turn() const;
};

/// Finds the head's frame: the cranium (the largest ball of soft tissue with bone on most sides), the mirror
/// plane by it, or by the inner air where the volume shows no vault, in which bone, inner air and skin agree
/// best with their mirror images, and the tilt within that plane at which a newborn's bones, air and skin lie
/// best on the volume's. Any turn will do. Left and right cannot be told: of a mirrored volume the frame is
/// that of the mirrored head. Throws VolumeError, beginning with "the volume", where there is no head.
[[nodiscard]] HeadFrame find_head(const imaging::Volume& volume, const SegmentSettings& settings);

}  // namespace eti::segmentation
