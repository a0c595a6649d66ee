// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/landmark.hpp"

namespace eti {

/// Landmarks [m] of a term newborn in the patient frame (left, posterior, superior): glottis 40 mm behind
/// and 31 mm below the upper gum at rest. `ready` has the head elevated by 26 deg and the mouth open:
/// what the skull and the jaw carry has moved, throat and chest have not.
inline Landmarks newborn_landmarks(bool ready) {
    Landmarks points = unseen_landmarks();
    const auto set = [&](Landmark which, float posterior_mm, float superior_mm) {
        points[static_cast<std::size_t>(which)] = Vec3f(0.0f, 1e-3f * posterior_mm, 1e-3f * superior_mm);
    };
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
    set(Landmark::upper_gum, ready ? 14.0f : 0.0f, ready ? 22.0f : 0.0f);
    set(Landmark::upper_lip, ready ? 7.0f : -8.0f, ready ? 26.0f : 0.5f);
    set(Landmark::lower_gum, ready ? 2.0f : 2.0f, ready ? 4.0f : -3.0f);
    set(Landmark::lower_lip, ready ? -7.0f : -7.0f, ready ? 6.0f : -3.0f);
    set(Landmark::mouth_opening, ready ? 0.0f : -7.5f, ready ? 16.0f : -1.0f);
    set(Landmark::tongue_tip, ready ? 6.0f : 3.0f, ready ? 4.0f : -2.0f);
    set(Landmark::tongue_dorsum, ready ? 25.0f : 21.5f, ready ? 10.0f : 7.0f);
    return points;
}

}  // namespace eti
