// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

#include "common/device/coupling.hpp"

namespace eti::devices {

/// For devices without torque: the force at a gimbal that resists rotation about a contact with the shell as
/// the wrenches of `shell` and `tissue` (both about `origin`) would. The force tau x r / |r|^2 is added to
/// theirs, where r is the vector from the contact to the gimbal and tau the torque about the contact that
/// their force at the gimbal lacks. No force can produce the part of the torque along r. An arm below 20 mm
/// counts as 20 mm, which bounds the force. All in m and N.
///
/// A fulcrum turns no more force around than it bears: what is added is at most the shell's own force plus
/// its torque about the contact by the arm. A contact that only touches therefore adds nothing, and the force
/// is continuous as contacts come and go.
[[nodiscard]] inline Vec3f gimbal_force(const Wrench& shell, const Wrench& tissue, const Vec3f& origin,
                                        const Vec3f& contact, const Vec3f& gimbal) {
    constexpr float shortest_arm = 0.02f;
    const Vec3f r = gimbal - contact;
    const float arm = std::max(r.norm(), shortest_arm);
    const auto about_contact = [&](const Wrench& wrench) -> Vec3f {
        return wrench.torque + Vec3f(origin - contact).cross(wrench.force);
    };
    const Vec3f force = shell.force + tissue.force, shell_torque = about_contact(shell);
    const Vec3f lacking = shell_torque + about_contact(tissue) - r.cross(force);
    const Vec3f added = lacking.cross(r) / (arm * arm);
    const float most = shell.force.norm() + shell_torque.norm() / arm, length = added.norm();
    return force + (length > most ? Vec3f(added * (most / length)) : added);
}

}  // namespace eti::devices
