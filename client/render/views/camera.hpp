// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <optional>

#include "client/render/views/section.hpp"
#include "client/view/sight/trainee_eye.hpp"
#include "common/math/transform.hpp"
#include "common/math/units.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::render {

/// Angles of a frustum's sides from the gaze [rad]; as in OpenXR, left and down are negative.
struct FieldOfView {
    float left, right, up, down;
};

/// A perspective camera in the patient frame; lengths in metres.
struct Camera {
    Vec3f eye = Vec3f::Zero();
    Vec3f target = -Vec3f::UnitZ();
    Vec3f up = -Vec3f::UnitY();
    float vertical_fov = 30.0f * degree;  ///< [rad]
    float near_plane = 0.05f;
    float far_plane = 2.0f;
    std::optional<FieldOfView> field{};  ///< overrides `vertical_fov`: for a lens that is off-axis

    [[nodiscard]] Eigen::Matrix4f view() const;
    [[nodiscard]] Eigen::Matrix4f projection(float aspect) const;
    /// Pose in OpenXR's convention: -z towards the target, +y up, +x right.
    [[nodiscard]] RigidTransform pose() const;
};

/// Position of the overview camera around the mouth. The patient lies supine; azimuth rotates about the
/// vertical, 0 from the head's side, 90 deg from the patient's left.
struct Orbit {
    float azimuth = 106.0f * degree;
    float elevation = 36.0f * degree;
    float distance = 0.66f;
};

/// `table_angle` [rad], positive head-up: the picture's vertical is the world's, so that the table appears
/// tilted.
[[nodiscard]] Camera overview_camera(const Landmarks& rest, const Orbit& orbit, float table_angle = 0.0f);

/// Looks perpendicularly at a section plane; a midline section from the patient's left, head to the right.
/// Scaled to the patient: lips to trachea.
[[nodiscard]] Camera section_camera(const Section& section, const Landmarks& rest, const Landmarks& now);

/// On the laryngoscope's blade beside its bulb, looking towards the tip, tongue side up, with a wide-angle
/// lens.
[[nodiscard]] Camera blade_camera(const RigidTransform& pose, const Laryngoscope& scope);

/// The trainee's eye, with the field around its target that a person sees clearly, through a loupe of this
/// magnification.
[[nodiscard]] Camera eye_camera(const view::TraineeEye& eye, const Landmarks& now,
                                float magnification = 1.0f);

/// An eye behind a headset's lens. `pose` in OpenXR's convention, patient frame.
[[nodiscard]] Camera headset_camera(const RigidTransform& pose, const FieldOfView& field);

/// The same eye's close-up: the mouth fills the picture.
[[nodiscard]] Camera close_up_camera(const view::TraineeEye& eye, const Landmarks& now);

}  // namespace eti::render
