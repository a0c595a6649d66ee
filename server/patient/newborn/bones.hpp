// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Bones in the newborn's model coordinates: x left, y anterior, z superior; millimetres of the 3.5 kg term
// newborn.
namespace eti::patient {

[[nodiscard]] float skull_field(const Vec3f& point, float cranium_size);
/// `in_jaw`: in the coordinates of the closed jaw.
[[nodiscard]] float mandible_field(const Vec3f& in_jaw);
[[nodiscard]] float spine_field(const Vec3f& p);
[[nodiscard]] float hyoid_field(const Vec3f& p);

}  // namespace eti::patient
