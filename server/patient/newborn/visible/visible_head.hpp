// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Drawn face, head and trunk in the newborn's model coordinates: x left, y anterior, z superior; millimetres
// of the 3.5 kg term newborn.
namespace eti::patient {

class BodyShape;

/// Outline of head, neck and trunk. `in_jaw`: the point in the coordinates of the closed jaw.
[[nodiscard]] float visible_skin(const Vec3f& point, const Vec3f& in_jaw, float cranium_size);

/// The same of a whole body. `usual_cranium_size`: with a head of the usual size for weight and age.
[[nodiscard]] float visible_skin(const BodyShape& body, const Vec3f& point, const Vec3f& in_jaw,
                                 float cranium_size, float usual_cranium_size, float rest_jaw_deg);

/// The cloth around the trunk.
[[nodiscard]] float visible_cloth(const Vec3f& p);

/// The nappy of a whole body. `skin`: visible_skin() at the point.
[[nodiscard]] float visible_nappy(float skin, const Vec3f& p);

/// Whether a point of the face lies on the lips' vermilion. `half`: the point half-way between the
/// coordinates of upper and lower jaw.
[[nodiscard]] bool on_lip(const Vec3f& half, float mouth_width);

/// Lower end of the cloth.
constexpr float trunk_end = -142.0f;

}  // namespace eti::patient
