// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "server/patient/segmentation/tissue_map.hpp"

namespace eti::segmentation {

/// Where level sets start, and the measures that searching them gave.
struct Placed {
    Points points;
    std::optional<Vec3d> chin;        ///< [m], the lowest of the mandible's points
    std::optional<double> jaw_depth;  ///< [m], chin to the back wall of the pharynx: the scale of the mouth
    std::string no_mandible;          ///< why there is no chin in the volume; empty where there is
};

/// What is known of the head before: its directions are the grid's.
struct HeadPlace {
    Vec3d plane_normal = Vec3d::UnitX();   ///< of the mirror plane
    Vec3d in_plane = Vec3d::Zero();        ///< [m], the cranium's centre
    double size = 36e-3;                   ///< [m], radius of the cranium's ball
    const imaging::Bits* shown = nullptr;  ///< voxels that the volume shows, where it does not show all

    /// The mirror plane's x at a height and depth.
    [[nodiscard]] double middle(double y, double z) const {
        const Vec3d& n = plane_normal;
        return in_plane.x() - (n.y() * (y - in_plane.y()) + n.z() * (z - in_plane.z())) / n.x();
    }
};

/// Finds, in this order, the mouth (where the airway opens lowest), the chin (the foremost bone in the
/// midline below it) with the rami beside the mouth, the spine (bone behind the airway), the skull (bone
/// above the jaw's joints) and the tongue (between chin and pharynx). `given` points stand in for found ones.
/// A chin that the volume's lower face cuts is none: it may be the upper jaw.
[[nodiscard]] Placed place_points(const imaging::Geometry& geometry, const TissueMap& map,
                                  const std::vector<float>& bone_depth, const HeadPlace& head,
                                  const Points& given);

}  // namespace eti::segmentation
