// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/patient/segmentation/placement/place_seeds.hpp"

namespace eti::segmentation {

/// Plausible size and position of an organ, in units of the cranium's radius (36 mm at term, about 62 mm in
/// adults), so that one set fits patients of all sizes.
struct OrganLimits {
    double min_volume, max_volume;      ///< [radii^3]
    double max_beside;                  ///< maximum distance of the organ's centre from the mirror plane
    double min_side;                    ///< minimum fraction of its volume on each side of the plane
    double min_below;                   ///< minimum distance of the organ's centre below the cranium's centre
    bool before_airway, behind_airway;  ///< required position of its centre relative to the airway's
};
// Term newborns have 0.13 (mandible), 0.32 (tongue), 0.11 (spine, as far as a phantom extends); adults of 35,
// 70 and 90 ml have 0.15, 0.29 and 0.38. Variants of mandible and tongue have half and three times as much.
// Chosen.
inline constexpr OrganLimits mandible_limits{0.02, 0.5, 0.25, 0.3, 0.8, true, false};
inline constexpr OrganLimits tongue_limits{0.06, 1.2, 0.25, 0.3, 0.8, false, false};
inline constexpr OrganLimits spine_limits{0.008, 0.8, 0.4, 0.2, 0.5, false, true};

/// Checks organs against the head. `geometry`: of the masks, in the head's directions.
class OrganCheck {
  public:
    OrganCheck(const imaging::Geometry& geometry, const HeadPose& head, const imaging::Bits& airway);

    /// Reason why this cannot be the organ; empty if it is plausible, has no voxels, or the head's size is
    /// unknown.
    [[nodiscard]] std::string implausibility(const imaging::Bits& organ, const OrganLimits& limits) const;
    /// Which of mandible, tongue and spine are out of order from front to back; empty masks are skipped.
    [[nodiscard]] std::string out_of_order(const imaging::Bits& mandible, const imaging::Bits& tongue,
                                           const imaging::Bits& spine) const;

  private:
    struct Extent {
        double volume = 0.0;  // [m^3]
        Vec3d middle = Vec3d::Zero();
        double left = 0.0;  // fraction of the volume
    };
    [[nodiscard]] Extent extent(const imaging::Bits& organ) const;

    imaging::Geometry geometry_;
    HeadPose head_;
    Extent airway_;
};

/// Reports names with more than a fifth of their points outside of their own organ, and `given` names with
/// any point in another distinguishable organ, farther than 8 mm from their own, or without any label. A
/// point belongs to the nearest organ within 8 mm. A point in bone may lie at its own organ's border, as some
/// automatically placed ones do.
void find_stray_seeds(const imaging::Mask& labels, const Points& points, const Points& given,
                      std::vector<std::string>& contradictions);

}  // namespace eti::segmentation
