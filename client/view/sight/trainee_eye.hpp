// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"

namespace eti::view {

/// The trainee's eye, patient frame: the camera of its picture, the published eye pose, and the start of
/// the line of sight. By default it is at the best view of the glottis, looks at it, and follows both as
/// head and jaw move; the trainee's offsets in position and gaze are added.
class TraineeEye {
  public:
    /// Limits: offset from the best position [m] along each axis, distance to the glottis [m], and gaze
    /// rotation [rad].
    static constexpr float max_offset = 0.25f, min_distance = 0.10f, max_gaze_turn = 0.6f;

    TraineeEye() = default;
    /// `offset` [m], patient frame, from the best position; each component is clamped to `max_offset`.
    explicit TraineeEye(const Vec3f& offset);
    /// Behind a headset's lens: follows the wearer's head, independent of the patient; keys and mouse do
    /// not move it.
    [[nodiscard]] static TraineeEye from_headset(const RigidTransform& pose);

    [[nodiscard]] const Vec3f& offset() const { return offset_; }
    [[nodiscard]] Vec3f position(const Landmarks& now) const;  ///< [m]
    /// In OpenXR's convention: -z along the gaze, +y up, the tongue's side, +x right.
    [[nodiscard]] RigidTransform pose(const Landmarks& now) const;

    /// Moves it by this much [m] to the right, up and back, relative to its view of the glottis.
    void move(const Vec3f& by, const Landmarks& now);
    /// Rotates the gaze by this much [rad] to the right and up.
    void turn(float right, float up);
    /// Returns to the best position.
    void settle() { *this = TraineeEye(); }

  private:
    Vec3f offset_ = Vec3f::Zero();
    float right_ = 0.0f, up_ = 0.0f;  // [rad], of the gaze, relative to the glottis
    std::optional<RigidTransform> headset_pose_;
};

}  // namespace eti::view
