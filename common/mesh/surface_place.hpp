// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/math/transform.hpp"

namespace eti {

/// A point attached to triangle a b c of a surface: a + u (b - a) + v (c - a) + height along the triangle's
/// normal.
struct SurfacePlace {
    /// Largest distance [m] of a point from its surface: the thickest part of a newborn's head.
    static constexpr float farthest = 0.1f;

    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
    float height = 0.0f;  ///< [m], outwards

    bool operator==(const SurfacePlace&) const = default;

    /// Whether the point lies within its triangle (up to rounding) and near it, and every number is finite.
    [[nodiscard]] bool is_valid() const {
        constexpr float rounding = 1e-4f;
        // Written so that NaN fails.
        return u >= -rounding && v >= -rounding && u + v <= 1.0f + rounding && std::abs(height) <= farthest;
    }
};

/// Position [m], given the triangle's corners [m]. The height is ignored on a triangle without area.
[[nodiscard]] inline Vec3f point_at(const SurfacePlace& place, const Vec3f& a, const Vec3f& b,
                                    const Vec3f& c) {
    const Vec3f normal = (b - a).cross(c - a);
    const float length = normal.norm();
    const Vec3f up = length > 0.0f ? Vec3f(normal / length) : Vec3f(Vec3f::Zero());
    return a + place.u * (b - a) + place.v * (c - a) + place.height * up;
}

}  // namespace eti
