// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/skeleton.hpp"

#include <algorithm>
#include <cmath>

namespace eti::patient {

Vec3f gravity(float table_angle) {
    constexpr float strength = 9.81f;
    // Head-up, gravity points towards the feet. 0 - 0 instead of -0: a level table must not change any bit.
    return {0.0f, strength * std::cos(table_angle), 0.0f - strength * std::sin(table_angle)};
}

BonePoses pose_bones(const Skeleton& skeleton, const Posture& posture) {
    return pose_joints(skeleton, {std::clamp(posture.head_elevation, 0.0f, max_head_elevation),
                                  std::clamp(posture.jaw_opening, 0.0f, max_jaw_opening)});
}

BonePoses pose_joints(const Skeleton& skeleton, const JointPositions& joints) {
    // Patient frame: x left, y posterior, z superior. Chin-up moves anterior (-y) to superior (+z): a
    // negative rotation about x. Opening moves the chin down: a positive one.
    RigidTransform skull = RigidTransform::about(skeleton.neck_joint, Vec3f::UnitX(), -joints.head_elevation);
    skull.translation.y() -= joints.head_lift;
    RigidTransform jaw = RigidTransform::about(skeleton.jaw_joint, Vec3f::UnitX(), joints.jaw_opening);
    jaw.translation.y() -= skeleton.jaw_slide_per_radian * joints.jaw_opening + joints.jaw_slide;
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

std::vector<BoneWeights> frame_bones(const Patient& patient) {
    std::vector<BoneWeights> of_frame(patient.frame_rest_centre.size());
    for (std::size_t f = 0; f < of_frame.size(); ++f) {
        BoneWeights& weights = of_frame[f];
        weights = {};
        if (f < bone_count) {
            weights[f] = 1.0f;
        } else if (f < bone_count + patient.clusters.size()) {
            const auto members = patient.clusters.members(f - bone_count);
            for (const std::uint32_t i : members) {
                for (std::size_t b = 0; b < bone_count; ++b) {
                    weights[b] += patient.particles.bones[i][b];
                }
            }
            for (float& w : weights) {
                w /= static_cast<float>(members.size());
            }
        } else {
            weights[static_cast<std::size_t>(Bone::skull)] = 1.0f;
        }
    }
    return of_frame;
}

std::vector<FramePose> posed_frames(const Patient& patient, const BonePoses& bones) {
    std::vector<FramePose> frames;
    for (const BoneWeights& weights : frame_bones(patient)) {
        const Vec3f& centre = patient.frame_rest_centre[frames.size()];
        frames.push_back({pose_point(centre, weights, bones), pose_rotation(weights, bones)});
    }
    return frames;
}

}  // namespace eti::patient
