// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <string_view>

#include "common/model/landmark.hpp"

namespace eti::view {

/// A straight piece of an axis [m], patient frame, and its name.
struct AirwayAxis {
    std::string_view name;
    Vec3f from = Vec3f::Zero(), to = Vec3f::Zero();  ///< outwards to inwards
};

/// The three axes that a laryngoscopist brings together, and the angles [rad] between neighbours (after Adnet
/// et al. 2001, Anesthesiology 94:83, who drew them in MR images): of the mouth, along the hard palate
/// through the mouth's opening; of the throat, along the front of the spine; of the larynx, from the glottis
/// down the trachea.
struct AirwayAxes {
    std::array<AirwayAxis, 3> axes;
    float mouth_to_throat = 0.0f, throat_to_larynx = 0.0f;
};

/// `head_elevation` [rad]: with it the palate turns.
[[nodiscard]] AirwayAxes airway_axes(const Landmarks& now, float head_elevation);

}  // namespace eti::view
