// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"

namespace eti::view {

/// The trainee's eye, in the patient's frame: what its picture is drawn from, what is published, and where
/// the line of sight begins. It stands where the glottis is best seen and looks at it, and follows both as
/// head and jaw move; by what the trainee moved it, it stands and looks aside of that.
class TraineeEye {
  public:
    /// So far [m] it goes from the best place, along each axis, so near to the glottis it comes, and so far
    /// [rad] it looks aside.
    static constexpr float farthest = 0.25f, nearest = 0.10f, most_turn = 0.6f;

    TraineeEye() = default;
    /// `offset` [m], patient frame, from the best place; each number is held within `farthest`.
    explicit TraineeEye(const Vec3f& offset);
    /// Behind a headset's lens: where the head holds it, whatever the patient does; keys and mouse do not
    /// move it.
    [[nodiscard]] static TraineeEye worn(const RigidTransform& pose);

    [[nodiscard]] const Vec3f& offset() const { return offset_; }
    [[nodiscard]] Vec3f position(const Landmarks& now) const;  ///< [m]
    /// As OpenXR has it: -z along the gaze, +y up, the tongue's side, +x right.
    [[nodiscard]] RigidTransform pose(const Landmarks& now) const;

    /// Moves it by so much [m] to the right, up and back, as it looks at the glottis.
    void move(const Vec3f& by, const Landmarks& now);
    /// Turns the gaze by so much [rad] to the right and up.
    void turn(float right, float up);
    /// Back to the best place.
    void settle() { *this = TraineeEye(); }

  private:
    Vec3f offset_ = Vec3f::Zero();
    float right_ = 0.0f, up_ = 0.0f;  // [rad], of the gaze, from the glottis
    std::optional<RigidTransform> worn_;
};

}  // namespace eti::view
