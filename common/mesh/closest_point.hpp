// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/math/transform.hpp"

namespace eti {

/// Parameter in [0, 1] of the point of segment a-b closest to `point`.
[[nodiscard]] inline float closest_on_segment(const Vec3f& a, const Vec3f& b, const Vec3f& point) {
    const Vec3f along = b - a;
    const float squared = along.squaredNorm();
    return squared > 0.0f ? std::clamp((point - a).dot(along) / squared, 0.0f, 1.0f) : 0.0f;
}

/// Vector from the closest point of segment a-b to `point`.
[[nodiscard]] inline Vec3f offset_from_segment(const Vec3f& a, const Vec3f& b, const Vec3f& point) {
    return point - a - closest_on_segment(a, b, point) * (b - a);
}

/// Part of a triangle that holds the closest point.
enum class Feature : std::uint8_t { vertex, edge, face };

struct ClosestPoint {
    Vec3f point = Vec3f::Zero();
    Feature feature = Feature::face;
    int index = 0;                 ///< corner, or edge from that corner to the next
    std::array<float, 3> areas{};  ///< of a face: in the ratio of the barycentric coordinates
};

/// Closest point of triangle a, b, c to p (Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5).
[[nodiscard]] ClosestPoint closest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b,
                                               const Vec3f& c);

/// Parameters s, t in [0, 1] of the closest points p0 + s (p1 - p0) and q0 + t (q1 - q0)
/// (Ericson 2005, sec. 5.1.9).
[[nodiscard]] std::array<float, 2> closest_on_segments(const Vec3f& p0, const Vec3f& p1, const Vec3f& q0,
                                                       const Vec3f& q1);

}  // namespace eti
