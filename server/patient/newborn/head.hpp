// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Outline of head and neck in the newborn's model coordinates: x left, y anterior, z superior; millimetres of
// the 3.5 kg term newborn.
namespace eti::anatomy {

/// The cranium grows from this height upwards and about this axis; face and airway do not follow it.
constexpr float cranium_floor = 26.0f;
constexpr float cranium_axis_y = -18.0f;

/// From a head whose cranium is `size` times the usual one to the usual head.
[[nodiscard]] Vec3f usual_cranium(const Vec3f& p, float size);
/// Back to the head whose cranium is of `size`.
[[nodiscard]] Vec3f sized_cranium(const Vec3f& p, float size);

[[nodiscard]] float skin_field(const Vec3f& point, const Vec3f& in_jaw, float cranium_size);

}  // namespace eti::anatomy
