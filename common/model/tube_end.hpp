// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "common/math/transform.hpp"

namespace eti {

/// How far along a tube its bevel is set back for each radius across it: 1 is a bevel of 45 degrees.
inline constexpr float bevel_slope = 1.0f;

/// The side of a tube's course that is concave, unit and normal to `tangent`, which is unit: where the curve
/// bends to. Of a straight one it is the patient's anterior.
[[nodiscard]] Vec3f concave_side(std::span<const Vec3f> nodes, const Vec3f& tangent);

/// The last part of a tube, taken as straight, which the bevel cuts.
struct TubeEnd {
    std::size_t nodes = 0;                             ///< so many come before `start`
    Vec3f start = Vec3f::Zero(), tip = Vec3f::Zero();  ///< [m], on the centre line
    /// Normal of the bevel's plane, of any length, out of the tube: p is cut off where
    /// (p - tip).dot(bevel) > beyond [m].
    Vec3f bevel = Vec3f::Zero();
    float beyond = 0.0f;
};

/// Of a tube along `nodes` [m], connector to tip; nothing where these are not two places apart.
[[nodiscard]] std::optional<TubeEnd> tube_end(std::span<const Vec3f> nodes, float radius);

}  // namespace eti
