// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "server/patient/segmentation/tissue_map.hpp"

namespace eti::segmentation {

/// Seeds of the level sets, and dimensions found on the way.
struct PlacedSeeds {
    Points points;
    std::optional<Vec3d> chin;        ///< [m], lowest of the mandible's points
    std::optional<double> jaw_depth;  ///< [m], chin to the posterior pharyngeal wall: the scale of the mouth
    std::string no_mandible;          ///< why the volume has no chin; empty if it has one
};

/// Prior knowledge of the head, whose directions are the grid's.
struct HeadPose {
    Vec3d plane_normal = Vec3d::UnitX();   ///< of the mirror plane
    Vec3d in_plane = Vec3d::Zero();        ///< [m], centre of the cranium
    double size = 36e-3;                   ///< [m], radius of the cranium's ball
    const imaging::Bits* shown = nullptr;  ///< voxels that the volume covers; null: all

    /// x of the mirror plane at a depth `y` and height `z`.
    [[nodiscard]] double middle(double y, double z) const {
        const Vec3d& n = plane_normal;
        return in_plane.x() - (n.y() * (y - in_plane.y()) + n.z() * (z - in_plane.z())) / n.x();
    }
};

/// Finds, in this order: the mouth (lowest opening of the airway); the chin (foremost bone in the midline
/// below it) with the rami beside the mouth; the spine (bone behind the airway); the skull (bone above the
/// jaw joints); the tongue (between chin and pharynx). `given` points replace found ones. A chin cut by the
/// volume's lower face is rejected: it may be the upper jaw.
[[nodiscard]] PlacedSeeds place_seeds(const imaging::Geometry& geometry, const TissueMap& map,
                                      const std::vector<float>& bone_depth, const HeadPose& head,
                                      const Points& given);

}  // namespace eti::segmentation
