// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti::devices {

/// Transforms from the operator frame to the patient frame: half a turn about z. The operator stands at the
/// patient's head and looks towards the feet (x right, y up, z towards the operator). The patient lies on the
/// back (x left, y down, z towards the head).
[[nodiscard]] inline Vec3f from_operator(const Vec3f& v) {
    return {-v.x(), -v.y(), v.z()};
}

/// `pose` translated by `way` [m] and rotated by `turn` [rad] about its own origin, both in the operator
/// frame.
[[nodiscard]] inline RigidTransform moved(const RigidTransform& pose, const Vec3f& way, const Vec3f& turn) {
    return {(quaternion_from(from_operator(turn)) * pose.rotation).normalized(),
            pose.translation + from_operator(way)};
}

}  // namespace eti::devices
