// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "common/math/transform.hpp"

namespace eti {

/// Axial setback of the bevel per radius across the tube: 1 is a bevel of 45 degrees.
inline constexpr float bevel_slope = 1.0f;

/// The concave side of a tube's course: a unit vector normal to the unit `tangent`, towards the centre of
/// curvature. For a straight tube, the patient's anterior.
[[nodiscard]] Vec3f concave_side(std::span<const Vec3f> nodes, const Vec3f& tangent);

/// The last part of a tube, taken as straight, which the bevel cuts.
struct TubeEnd {
    std::size_t nodes = 0;                             ///< number of nodes before `start`
    Vec3f start = Vec3f::Zero(), tip = Vec3f::Zero();  ///< [m], on the centre line
    /// Outward normal of the bevel's plane, of any length: a point p is cut off where (p - tip).dot(bevel) >
    /// beyond [m].
    Vec3f bevel = Vec3f::Zero();
    float beyond = 0.0f;
};

/// The end of a tube along `nodes` [m], connector to tip; nullopt where these are not two distinct positions.
[[nodiscard]] std::optional<TubeEnd> tube_end(std::span<const Vec3f> nodes, float radius);

}  // namespace eti
