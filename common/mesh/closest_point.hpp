// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti {

/// The point of triangle abc closest to `point` (Ericson, Real-Time Collision Detection, 5.1.5).
[[nodiscard]] Vec3f closest_point(const Vec3f& point, const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace eti
