// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Outline of head and neck in the newborn's model coordinates: x left, y anterior, z superior; millimetres of
// the 3.5 kg term newborn.
namespace eti::patient {

/// Height and axis of the cranium's growth; face and airway do not follow it.
constexpr float cranium_floor = 26.0f;
constexpr float cranium_axis_y = -18.0f;

/// Maps a point of a head whose cranium has `size` times the standard size to the standard head.
[[nodiscard]] Vec3f to_standard_cranium(const Vec3f& p, float size);
/// The inverse of to_standard_cranium().
[[nodiscard]] Vec3f to_scaled_cranium(const Vec3f& p, float size);

[[nodiscard]] float skin_field(const Vec3f& point, const Vec3f& in_jaw, float cranium_size);

}  // namespace eti::patient
