// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/camera.hpp"
#include "common/math/transform.hpp"

namespace eti::hmd {

/// Where the patient lies in the trainee's room. The world is OpenXR's local space: metres, y up, -z ahead,
/// its origin where the eyes were when the headset was last centred.
struct Room {
    /// Of the upper gum. By default the eyes are 0.36 m from it, on the line along which an extended head
    /// shows its glottis.
    Vec3f gum{0.0f, -0.20f, -0.30f};

    /// No farther than this along each axis [m].
    static constexpr float farthest = 2.0f;

    /// The patient's frame in the world. The trainee stands at the head of a patient on its back. The table
    /// turns about the gum, so that the mouth stays before the trainee; `table_angle` [rad], positive
    /// head-up; NaN, while it is unknown, is level.
    [[nodiscard]] RigidTransform patient(float table_angle) const;
};

}  // namespace eti::hmd
