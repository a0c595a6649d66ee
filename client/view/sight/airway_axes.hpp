// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <string_view>

#include "common/model/landmark.hpp"

namespace eti::view {

/// A straight segment of an axis [m], patient frame, with its name.
struct AirwayAxis {
    std::string_view name;
    Vec3f from = Vec3f::Zero(), to = Vec3f::Zero();  ///< from outside to inside
};

/// The three axes that a laryngoscopist aligns, and the angles [rad] between neighbours (after Adnet et al.
/// 2001, Anesthesiology 94:83, who drew them in MR images). The mouth's axis follows the hard palate
/// through the mouth's opening, the pharynx's the front of the spine, and the larynx's leads from the
/// glottis down the trachea.
struct AirwayAxes {
    std::array<AirwayAxis, 3> axes;
    float mouth_to_throat = 0.0f, throat_to_larynx = 0.0f;
};

/// `head_elevation` [rad]: rotates the palate.
[[nodiscard]] AirwayAxes airway_axes(const Landmarks& now, float head_elevation);

}  // namespace eti::view
