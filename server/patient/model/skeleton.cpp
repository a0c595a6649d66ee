// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/skeleton.hpp"

#include <algorithm>
#include <cmath>

namespace eti::anatomy {

Vec3f gravity(float table_angle) {
    constexpr float strength = 9.81f;
    // Head-up, it pulls towards the feet. Of 0 - 0 rather than -0: a level table leaves no trace in any bit.
    return {0.0f, strength * std::cos(table_angle), 0.0f - strength * std::sin(table_angle)};
}

BonePoses pose_bones(const Skeleton& skeleton, const Posture& posture) {
    const float elevation = std::clamp(posture.head_elevation, 0.0f, max_head_elevation);
    const float opening = std::clamp(posture.jaw_opening, 0.0f, max_jaw_opening);
    // Patient frame: x left, y posterior, z superior. Chin-up carries anterior (-y) to superior (+z):
    // a negative turn about x. Opening carries the chin down: a positive turn.
    const RigidTransform skull = RigidTransform::about(skeleton.neck_joint, Vec3f::UnitX(), -elevation);
    RigidTransform jaw = RigidTransform::about(skeleton.jaw_joint, Vec3f::UnitX(), opening);
    jaw.translation.y() -= skeleton.jaw_slide_per_radian * opening;
    return {RigidTransform{}, skull, skull * jaw};
}

Quatf pose_rotation(const BoneWeights& weights, const BonePoses& bones) {
    Eigen::Vector4f sum = Eigen::Vector4f::Zero();
    for (std::size_t b = 0; b < bone_count; ++b) {
        const Eigen::Vector4f q = bones[b].rotation.coeffs();
        sum += weights[b] * (q.dot(bones[0].rotation.coeffs()) < 0.0f ? Eigen::Vector4f(-q) : q);
    }
    Quatf blended;
    blended.coeffs() = sum.normalized();
    return blended;
}

}  // namespace eti::anatomy
