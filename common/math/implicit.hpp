// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/transform.hpp"

// Implicit shapes: negative inside, approximately the distance near the surface. Units are the caller's, used
// consistently.
namespace eti {

/// Union with a fillet of width k (polynomial smooth minimum, Quilez).
[[nodiscard]] inline float smooth_union(float a, float b, float k) {
    const float h = std::max(k - std::fabs(a - b), 0.0f) / k;
    return std::min(a, b) - h * h * k * 0.25f;
}

/// Intersection with a fillet of width k.
[[nodiscard]] inline float smooth_intersection(float a, float b, float k) {
    return -smooth_union(-a, -b, k);
}

/// `a` without `b`, with a fillet of width k.
[[nodiscard]] inline float smooth_difference(float a, float b, float k) {
    return smooth_intersection(a, -b, k);
}

/// A capsule whose radius varies linearly from ra at a to rb at b.
[[nodiscard]] inline float round_cone(const Vec3f& p, const Vec3f& a, const Vec3f& b, float ra, float rb) {
    const Vec3f d = b - a;
    const float t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0f, 1.0f);
    return (p - a - d * t).norm() - (ra + (rb - ra) * t);
}

}  // namespace eti
