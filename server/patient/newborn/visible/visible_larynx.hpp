// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Drawn larynx, epiglottis and trachea in the newborn's model coordinates: x left, y anterior, z superior;
// millimetres of the 3.5 kg term newborn. Positions agree with larynx.hpp.
namespace eti::patient {

/// The omega-shaped plate with its tubercle.
[[nodiscard]] float visible_epiglottis(const Vec3f& p);

/// Arytenoids with their tubercles, aryepiglottic and glosso-epiglottic folds, and the body below, without
/// lumen.
[[nodiscard]] float visible_laryngeal_solid(const Vec3f& p);

/// Lumen from the inlet to both main bronchi.
[[nodiscard]] float visible_laryngeal_lumen(const Vec3f& p);

/// Whether a point near the lumen's wall is on the white true vocal cords.
[[nodiscard]] bool on_vocal_cord(const Vec3f& p);

/// Fraction of the epiglottis's motion that a point of the folds beside it follows: 1 at the plate, 0 at
/// arytenoids, tongue and pharyngeal wall. `plate`, `solid`: visible_epiglottis() and
/// visible_laryngeal_solid() at the point.
[[nodiscard]] float plate_coupling(const Vec3f& p, float plate, float solid);

}  // namespace eti::patient
