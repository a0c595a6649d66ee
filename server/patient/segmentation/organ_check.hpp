// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/patient/segmentation/place_points.hpp"

namespace eti::segmentation {

/// What an organ may be, in lengths of the cranium's radius (36 mm at term, about 62 mm in adults), which
/// takes patients of all sizes together.
struct OrganLimits {
    double least_volume, most_volume;   ///< [cubes of that length]
    double most_beside;                 ///< from the mirror plane to the organ's middle
    double least_side;                  ///< share of its volume left and right of the plane
    double least_below;                 ///< from the cranium's centre down to the organ's middle
    bool before_airway, behind_airway;  ///< where its middle lies from the airway's
};
// Term newborns have 0.13 (mandible), 0.32 (tongue), 0.11 (spine, as far as a phantom goes); adults of 35, 70
// and 90 ml have 0.15, 0.29 and 0.38. Variants of mandible and tongue have half and three times as much.
// Chosen.
inline constexpr OrganLimits mandible_limits{0.02, 0.5, 0.25, 0.3, 0.8, true, false};
inline constexpr OrganLimits tongue_limits{0.06, 1.2, 0.25, 0.3, 0.8, false, false};
inline constexpr OrganLimits spine_limits{0.008, 0.8, 0.4, 0.2, 0.5, false, true};

/// Holds organs against the head that they lie in. `geometry` is the masks', seen in the head's directions.
class OrganCheck {
  public:
    OrganCheck(const imaging::Geometry& geometry, const HeadPlace& head, const imaging::Bits& airway);

    /// Why this is not the organ; empty where nothing speaks against it, where there are no voxels, and where
    /// the head's size is not known.
    [[nodiscard]] std::string implausible(const imaging::Bits& organ, const OrganLimits& limits) const;
    /// Which of mandible, tongue and spine do not follow each other from front to back; empty masks are
    /// skipped.
    [[nodiscard]] std::string out_of_order(const imaging::Bits& mandible, const imaging::Bits& tongue,
                                           const imaging::Bits& spine) const;

  private:
    struct Extent {
        double volume = 0.0;  // [m^3]
        Vec3d middle = Vec3d::Zero();
        double left = 0.0;  // share of the volume
    };
    [[nodiscard]] Extent extent(const imaging::Bits& organ) const;

    imaging::Geometry geometry_;
    HeadPlace head_;
    Extent airway_;
};

/// Says which names have more than a fifth of their points outside of their own organ, and which of the
/// `given` ones have any in another that is told apart, or farther than 8 mm from their own, or no label at
/// all. A point belongs to the nearest organ within 8 mm. One in bone may lie at its own organ's border, as
/// some of those do that are placed.
void find_stray_seeds(const imaging::Mask& labels, const Points& points, const Points& given,
                      std::vector<std::string>& contradictions);

}  // namespace eti::segmentation
