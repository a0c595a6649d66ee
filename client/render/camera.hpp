// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <optional>

#include "client/render/section.hpp"
#include "client/view/trainee_eye.hpp"
#include "common/math/transform.hpp"
#include "common/math/units.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tools.hpp"

namespace eti::render {

/// How far a picture reaches to each side of the gaze [rad]; as OpenXR has it, to the left and down negative.
struct Field {
    float left, right, up, down;
};

/// A perspective camera in the patient frame; lengths in metres.
struct Camera {
    Vec3f eye = Vec3f::Zero();
    Vec3f target = -Vec3f::UnitZ();
    Vec3f up = -Vec3f::UnitY();
    float vertical_field = 30.0f * degree;  ///< [rad]
    float near_plane = 0.05f;
    float far_plane = 2.0f;
    std::optional<Field> field{};  ///< instead of `vertical_field`: of a lens that is not centred on the gaze

    [[nodiscard]] Eigen::Matrix4f view() const;
    [[nodiscard]] Eigen::Matrix4f projection(float aspect) const;
    /// Pose as OpenXR has it: -z towards the target, +y up, +x right.
    [[nodiscard]] RigidTransform pose() const;
};

/// Where the overview stands around the mouth. The baby lies on its back; azimuth turns about the
/// vertical, 0 from the head's side, 90 deg from the patient's left.
struct Orbit {
    float azimuth = 84.0f * degree;
    float elevation = 42.0f * degree;
    float distance = 0.56f;
};

/// `table_angle` [rad], positive head-up: the picture's vertical is the world's, so that the table shows as
/// tilted.
[[nodiscard]] Camera overview_camera(const Landmarks& rest, const Orbit& orbit, float table_angle = 0.0f);

/// Straight onto the plane of a section; along the middle from the patient's left, head to the right. As much
/// as the patient's size needs: lips to trachea.
[[nodiscard]] Camera section_camera(const Section& section, const Landmarks& rest, const Landmarks& now);

/// On the laryngoscope's blade beside its bulb, looking along to the tip, the tongue's side up; of a wide
/// lens.
[[nodiscard]] Camera blade_camera(const RigidTransform& pose, const Laryngoscope& scope);

/// The trainee's eye, with as much around what it looks at as a person sees clearly.
[[nodiscard]] Camera eye_camera(const view::TraineeEye& eye, const Landmarks& now);

/// An eye behind a headset's lens. `pose` as OpenXR has it, in the patient frame.
[[nodiscard]] Camera worn_camera(const RigidTransform& pose, const Field& field);

/// The same eye's close-up: the mouth fills the picture.
[[nodiscard]] Camera close_up_camera(const view::TraineeEye& eye, const Landmarks& now);

}  // namespace eti::render
