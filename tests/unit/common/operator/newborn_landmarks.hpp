// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/landmark.hpp"

namespace eti {

/// Landmarks [m] of a term newborn positioned for intubation in the patient frame (left, posterior,
/// superior): head elevated by 26 deg, mouth open. At rest the upper gum is the origin; the glottis lies 40
/// mm behind and 31 mm below it.
inline Landmarks newborn_landmarks() {
    Landmarks points = zero_landmarks();
    const auto set = [&](Landmark which, float posterior_mm, float superior_mm) {
        points[static_cast<std::size_t>(which)] = Vec3f(0.0f, 1e-3f * posterior_mm, 1e-3f * superior_mm);
    };
    set(Landmark::upper_gum, 14, 22);
    set(Landmark::lower_gum, 2, 4);
    set(Landmark::upper_lip, 7, 26);
    set(Landmark::lower_lip, -7, 6);
    set(Landmark::mouth_opening, 0, 16);
    set(Landmark::tongue_tip, 6, 4);
    set(Landmark::tongue_dorsum, 25, 10);
    set(Landmark::vallecula, 37, -20);
    set(Landmark::epiglottis_tip, 42, -13);
    set(Landmark::epiglottis_base, 36, -24);
    set(Landmark::glottis, 40, -31);
    set(Landmark::glottis_anterior, 37, -30);
    set(Landmark::glottis_posterior, 43, -31);
    set(Landmark::trachea_mid, 44, -55);
    set(Landmark::carina, 49, -80);
    set(Landmark::oesophagus_inlet, 48, -33);
    set(Landmark::oesophagus_mid, 52, -55);
    return points;
}

}  // namespace eti
