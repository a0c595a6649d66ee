// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

#include "common/math/implicit.hpp"
#include "common/math/smoothstep.hpp"
#include "common/math/transform.hpp"

// Implicit shapes: negative inside, approximately the distance near the surface. Units are the caller's, used
// consistently (the newborn model: millimetres).
namespace eti::patient {

/// First-order distance to an axis-aligned ellipsoid.
[[nodiscard]] inline float ellipsoid(const Vec3f& p, const Vec3f& centre, const Vec3f& radii) {
    const Vec3f q = p - centre;
    const float k0 = q.cwiseQuotient(radii).norm();
    const float k1 = q.cwiseQuotient(radii.cwiseProduct(radii)).norm();
    return k1 > 1e-9f ? k0 * (k0 - 1.0f) / k1 : -radii.minCoeff();
}

/// A chain of capsules; the radius varies linearly from r0 at the first point to r1 at the last.
[[nodiscard]] inline float chain(const Vec3f& p, std::span<const Vec3f> points, float r0, float r1) {
    float best = 1e9f;
    const auto last = static_cast<float>(points.size() - 1);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const auto t = static_cast<float>(i);
        best = std::min(best, round_cone(p, points[i], points[i + 1], r0 + (r1 - r0) * t / last,
                                         r0 + (r1 - r0) * (t + 1.0f) / last));
    }
    return best;
}

/// A station of a duct with a mid-sagittal axis.
struct Station {
    float anterior, superior;  ///< axis point
    float lateral, sagittal;   ///< semi-axes of the elliptical section
};

/// A duct with elliptical sections through stations.
[[nodiscard]] float duct(const Vec3f& p, std::span<const Station> stations);

[[nodiscard]] inline float chain(const Vec3f& p, std::initializer_list<Vec3f> points, float r0, float r1) {
    return chain(p, std::span(points.begin(), points.size()), r0, r1);
}

[[nodiscard]] inline float duct(const Vec3f& p, std::initializer_list<Station> stations) {
    return duct(p, std::span(stations.begin(), stations.size()));
}

/// Mirrors a point to the left half, for symmetric shapes.
[[nodiscard]] inline Vec3f mirrored(const Vec3f& p) {
    return {std::fabs(p.x()), p.y(), p.z()};
}

}  // namespace eti::patient
