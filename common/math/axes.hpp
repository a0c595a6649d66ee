// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti {

/// Right, up and back axes of a view from `eye` to `target`, with `up` as near to upwards as possible.
[[nodiscard]] inline Mat3f view_axes(const Vec3f& eye, const Vec3f& target, const Vec3f& up) {
    const Vec3f way = eye - target;
    const Vec3f back = way.norm() > 1e-6f ? Vec3f(way.normalized()) : Vec3f::UnitZ();
    const Vec3f across = up.cross(back);
    const Vec3f right = across.norm() > 1e-4f ? Vec3f(across.normalized()) : Vec3f(back.unitOrthogonal());
    return (Mat3f() << right, back.cross(right), back).finished();
}

/// Axes of a tool whose z points along `direction`. Its x points to the patient's left as far as z allows. As
/// in a hand, the handle then points anterior where the tool points inferior, and inferior where it points
/// posterior.
[[nodiscard]] inline Mat3f tool_axes(const Vec3f& direction) {
    const Vec3f left(1.0f, 0.0f, 0.0f);
    const Vec3f z = direction.squaredNorm() > 1e-12f ? Vec3f(direction.normalized()) : Vec3f(Vec3f::UnitY());
    Vec3f x = left - z * z.dot(left);
    if (x.squaredNorm() < 1e-6f) {
        x = z.unitOrthogonal();
    }
    x.normalize();
    return (Mat3f() << x, z.cross(x), z).finished();
}

}  // namespace eti
