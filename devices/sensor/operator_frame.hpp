// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti::devices {

/// From the frame of somebody who stands at the patient's head and looks towards the feet (x right, y up,
/// z towards the own body) to the patient frame of the patient who lies on the back (x left, y down,
/// z towards the head): half a turn about z.
[[nodiscard]] inline Vec3f from_operator(const Vec3f& v) {
    return {-v.x(), -v.y(), v.z()};
}

/// `pose` moved by `way` [m] and turned by `turn` [rad] about its own place, both as the operator sees them.
[[nodiscard]] inline RigidTransform moved(const RigidTransform& pose, const Vec3f& way, const Vec3f& turn) {
    return {(quaternion_from(from_operator(turn)) * pose.rotation).normalized(),
            pose.translation + from_operator(way)};
}

}  // namespace eti::devices
