// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

#include "common/device/coupling.hpp"

namespace eti::devices {

/// For devices without torque: the force at a gimbal that resists rotation about a contact as `wrench` (about
/// `origin`) would. The force tau x r / |r|^2 is added, where r is the vector from the contact to the gimbal
/// and tau the torque about the contact that the force at the gimbal lacks. No force can produce the part of
/// the torque along r. An arm below 20 mm counts as 20 mm, which bounds the force. All in m and N.
[[nodiscard]] inline Vec3f gimbal_force(const Wrench& wrench, const Vec3f& origin, const Vec3f& contact,
                                        const Vec3f& gimbal) {
    constexpr float shortest_arm = 0.02f;
    const Vec3f r = gimbal - contact;
    const Vec3f wanted = wrench.torque + Vec3f(origin - contact).cross(wrench.force);
    const Vec3f lacking = wanted - r.cross(wrench.force);
    return wrench.force + lacking.cross(r) / std::max(r.squaredNorm(), shortest_arm * shortest_arm);
}

}  // namespace eti::devices
