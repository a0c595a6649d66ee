// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/room.hpp"

#include <cmath>
#include <numbers>

namespace eti::hmd {

RigidTransform Room::patient(float table_angle) const {
    // The patient lies supine with the head towards the trainee: y is down, z back, and therefore x to the
    // left.
    const Quatf lying(Eigen::AngleAxisf(std::numbers::pi_v<float>, Vec3f::UnitZ()));
    const Quatf tilted(Eigen::AngleAxisf(std::isfinite(table_angle) ? table_angle : 0.0f, Vec3f::UnitX()));
    return RigidTransform::from((lying * tilted).normalized(), gum);
}

}  // namespace eti::hmd
