// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/views/camera.hpp"
#include "common/math/transform.hpp"

namespace eti::hmd {

/// The patient's place in the trainee's room. The world is OpenXR's local space: metres, y up, -z ahead,
/// origin at the eyes when the headset was last recentred.
struct Room {
    /// Position of the upper gum. By default the eyes are 0.36 m from it, on the line along which an
    /// extended head shows its glottis.
    Vec3f gum{0.0f, -0.20f, -0.30f};

    /// Maximum offset along each axis [m].
    static constexpr float max_offset = 2.0f;

    /// The patient frame in the world. The trainee stands at the head of a supine patient. The table
    /// rotates about the gum, so that the mouth stays in front of the trainee; `table_angle` [rad],
    /// positive head-up. NaN (unknown) is treated as level.
    [[nodiscard]] RigidTransform patient(float table_angle) const;
};

}  // namespace eti::hmd
