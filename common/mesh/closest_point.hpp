// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>

#include "common/math/transform.hpp"

namespace eti {

/// The point of triangle abc closest to `point` (Ericson, Real-Time Collision Detection, 5.1.5).
[[nodiscard]] Vec3f closest_point(const Vec3f& point, const Vec3f& a, const Vec3f& b, const Vec3f& c);

/// Parameters s, t in [0, 1] of the closest points p0 + s (p1 - p0) and q0 + t (q1 - q0)
/// (Ericson 2005, sec. 5.1.9).
[[nodiscard]] std::array<float, 2> closest_on_segments(const Vec3f& p0, const Vec3f& p1, const Vec3f& q0,
                                                       const Vec3f& q1);

}  // namespace eti
