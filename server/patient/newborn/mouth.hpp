// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Mouth and throat in the newborn's model coordinates: x left, y anterior, z superior; millimetres of the
// 3.5 kg term newborn. `in_jaw`: in the coordinates of the closed jaw.
namespace eti::anatomy {

struct Gums {
    float upper, lower;
};
[[nodiscard]] Gums gum_fields(const Vec3f& p, const Vec3f& in_jaw);

/// The space beneath the palate.
[[nodiscard]] float oral_vault(const Vec3f& p);
[[nodiscard]] float hard_palate(const Vec3f& p);
[[nodiscard]] float soft_palate(const Vec3f& p);

/// From here the tongue grows, and shrinks, to all sides.
inline const Vec3f tongue_centre(0, 18, -18);
[[nodiscard]] float tongue_shape(const Vec3f& in_jaw, float scale);
//// Between the tip's underside and the floor, from side to side but for the frenulum, which the tongue
/// keeps.
/// The tip rests on gum and floor: one sees into this space where the tongue is lifted or cut.
[[nodiscard]] float sublingual_space(const Vec3f& in_jaw);

/// Air of mouth, pharynx and gullet, before palate, gums and larynx are put in.
[[nodiscard]] float throat_and_mouth(const Vec3f& p, const Vec3f& in_jaw, float rest_jaw_deg,
                                     float mouth_width);

struct Cavities {
    float air, larynx, cricoid;
};
/// Lumen of mouth, pharynx, larynx and gullet, and the solid larynx that it runs through.
[[nodiscard]] Cavities cavity_fields(const Vec3f& p, const Vec3f& in_jaw, const Gums& gums,
                                     float rest_jaw_deg, float mouth_width);

}  // namespace eti::anatomy
