// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Face, head and trunk as one sees them, in the newborn's model coordinates: x left, y anterior, z superior;
// millimetres of the 3.5 kg term newborn.
namespace eti::anatomy {

/// Outline of head, neck and trunk. `in_jaw`: the point in the coordinates of the closed jaw.
[[nodiscard]] float seen_skin(const Vec3f& point, const Vec3f& in_jaw, float cranium_size);

/// The cloth that is wrapped about the trunk.
[[nodiscard]] float seen_cloth(const Vec3f& p);

/// Whether a point of the face lies on the lips' vermilion: `half`, half-way between the jaws' coordinates.
[[nodiscard]] bool on_lip(const Vec3f& half, float mouth_width);

/// Where the cloth's bundle ends below.
constexpr float trunk_end = -142.0f;

}  // namespace eti::anatomy
