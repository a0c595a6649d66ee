// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Mouth and throat in the newborn's model coordinates: x left, y anterior, z superior; millimetres of the
// 3.5 kg term newborn. `in_jaw`: in the coordinates of the closed jaw.
namespace eti::patient {

struct Gums {
    float upper, lower;
};
[[nodiscard]] Gums gum_fields(const Vec3f& p, const Vec3f& in_jaw);

/// The space beneath the palate.
[[nodiscard]] float oral_vault(const Vec3f& p);
[[nodiscard]] float hard_palate(const Vec3f& p);
[[nodiscard]] float soft_palate(const Vec3f& p);

/// Centre of the tongue's growth.
inline const Vec3f tongue_centre(0, 18, -18);
[[nodiscard]] float tongue_shape(const Vec3f& in_jaw, float scale);
/// Gap between the underside of the tip and the floor of the mouth, on both sides of the frenulum, which is
/// part of the tongue. The tip rests on gum and floor: the gap is visible when the tongue is lifted or cut.
[[nodiscard]] float sublingual_space(const Vec3f& in_jaw);

/// Air of mouth, pharynx and gullet, before palate, gums and larynx are subtracted.
[[nodiscard]] float throat_and_mouth(const Vec3f& p, const Vec3f& in_jaw, float rest_jaw_deg,
                                     float mouth_width);

struct Cavities {
    float air, larynx, cricoid;
};
/// Lumen of mouth, pharynx, larynx and gullet, and the solid larynx around it.
[[nodiscard]] Cavities cavity_fields(const Vec3f& p, const Vec3f& in_jaw, const Gums& gums,
                                     float rest_jaw_deg, float mouth_width);

}  // namespace eti::patient
