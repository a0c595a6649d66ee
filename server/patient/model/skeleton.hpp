// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/posture_range.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// [m/s^2], patient frame. On a level table the patient lies supine: +y is posterior.
[[nodiscard]] Vec3f gravity(float table_angle);

/// Transforms of trunk, skull and mandible from rest to a posture, patient frame.
using BonePoses = std::array<RigidTransform, bone_count>;

/// Poses the bones. The skull rotates about the neck joint (positive: chin up); the mandible follows it and
/// rotates about the jaw joints, whose condyles slide forward as the mouth opens. Angles are clamped to their
/// ranges.
[[nodiscard]] BonePoses pose_bones(const Skeleton& skeleton, const Posture& posture);

/// Positions of the joints, without limits.
struct JointPositions {
    float head_elevation = 0.0f;  ///< [rad]
    float jaw_opening = 0.0f;     ///< [rad]
    float head_lift = 0.0f;       ///< [m], anterior
    float jaw_slide = 0.0f;       ///< [m], anterior in the skull, in addition to that of the opening
};
[[nodiscard]] BonePoses pose_joints(const Skeleton& skeleton, const JointPositions& joints);

/// Linear blend of the bones' transforms at a rest point.
[[nodiscard]] inline Vec3f pose_point(const Vec3f& rest, const BoneWeights& weights, const BonePoses& bones) {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t b = 0; b < bone_count; ++b) {
        if (weights[b] > 0.0f) {
            sum += weights[b] * (bones[b] * rest);
        }
    }
    return sum;
}

/// Blended rotation of the bones at a point with the given weights.
[[nodiscard]] Quatf pose_rotation(const BoneWeights& weights, const BonePoses& bones);

/// Bone weights of each of the patient's frames at rest: for a cluster, the mean over its members.
[[nodiscard]] std::vector<BoneWeights> frame_bones(const Patient& patient);

/// Frames in a posture without load on the tissue, with the cranium as built.
[[nodiscard]] std::vector<FramePose> posed_frames(const Patient& patient, const BonePoses& bones);

}  // namespace eti::patient
