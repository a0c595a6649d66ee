// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

#include "common/device/coupling.hpp"

namespace eti::devices {

/// The force at a gimbal that resists turning about a contact as `wrench` (about `origin`) would, for devices
/// without torque: to its force comes tau x r / |r|^2, with tau the torque about the contact that the force
/// at the gimbal does not have, and r from the contact to the gimbal. The part of the torque along r no
/// force can have. An arm below 20 mm counts as 20 mm, so that the force stays bounded. All in m and N.
[[nodiscard]] inline Vec3f gimbal_force(const Wrench& wrench, const Vec3f& origin, const Vec3f& contact,
                                        const Vec3f& gimbal) {
    constexpr float shortest_arm = 0.02f;
    const Vec3f r = gimbal - contact;
    const Vec3f wanted = wrench.torque + Vec3f(origin - contact).cross(wrench.force);
    const Vec3f lacking = wanted - r.cross(wrench.force);
    return wrench.force + lacking.cross(r) / std::max(r.squaredNorm(), shortest_arm * shortest_arm);
}

}  // namespace eti::devices
