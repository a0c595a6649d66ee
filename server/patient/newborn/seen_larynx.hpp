// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Larynx, epiglottis and windpipe as one sees them, in the newborn's model coordinates: x left, y anterior,
// z superior; millimetres of the 3.5 kg term newborn. They lie where larynx.hpp has them.
namespace eti::anatomy {

/// The omega-shaped plate with its tubercle.
[[nodiscard]] float seen_epiglottis(const Vec3f& p);

/// Arytenoids with their tubercles, aryepiglottic and glosso-epiglottic folds, the body below, as if without
/// lumen.
[[nodiscard]] float seen_laryngeal_solid(const Vec3f& p);

/// From the inlet to both main bronchi.
[[nodiscard]] float seen_laryngeal_lumen(const Vec3f& p);

/// Whether a point near the lumen's wall shows the true cords' white.
[[nodiscard]] bool on_vocal_cord(const Vec3f& p);

/// How much of what the epiglottis does a point of the folds beside it does, too: 1 at the plate, 0 at
/// arytenoids, tongue and wall of the throat. `plate`, `solid`: seen_epiglottis() and seen_laryngeal_solid()
/// there.
[[nodiscard]] float hung_on_plate(const Vec3f& p, float plate, float solid);

}  // namespace eti::anatomy
