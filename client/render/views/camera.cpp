// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/camera.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/axes.hpp"
#include "common/model/tools/blade_camera.hpp"

namespace eti::render {
namespace {

constexpr float room_far = 5.0f;  // [m], beyond the walls

}  // namespace

Eigen::Matrix4f Camera::view() const {
    const Mat3f axes = view_axes(eye, target, up);
    Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
    matrix.topLeftCorner<3, 3>() = axes.transpose();
    matrix.topRightCorner<3, 1>() = -(axes.transpose() * eye);
    return matrix;
}

Eigen::Matrix4f Camera::projection(float aspect) const {
    Eigen::Matrix4f matrix = Eigen::Matrix4f::Zero();
    if (field) {
        const float left = std::tan(field->left), right = std::tan(field->right);
        const float up_to = std::tan(field->up), down_to = std::tan(field->down);
        matrix(0, 0) = 2.0f / (right - left);
        matrix(0, 2) = (right + left) / (right - left);
        matrix(1, 1) = 2.0f / (up_to - down_to);
        matrix(1, 2) = (up_to + down_to) / (up_to - down_to);
    } else {
        const float focal = 1.0f / std::tan(0.5f * vertical_fov);
        matrix(0, 0) = focal / aspect;
        matrix(1, 1) = focal;
    }
    matrix(2, 2) = (far_plane + near_plane) / (near_plane - far_plane);
    matrix(2, 3) = 2.0f * far_plane * near_plane / (near_plane - far_plane);
    matrix(3, 2) = -1.0f;
    return matrix;
}

RigidTransform Camera::pose() const {
    return RigidTransform::from(Quatf(view_axes(eye, target, up)).normalized(), eye);
}

Camera overview_camera(const Landmarks& rest, const Orbit& orbit, float table_angle) {
    Camera camera;
    // Slightly behind the lips, so that face, handle and tube are in the picture.
    camera.target = at(rest, Landmark::mouth_opening) + Vec3f(0.0f, -0.01f, 0.015f);
    const float elevation = std::clamp(orbit.elevation, -80.0f * degree, 85.0f * degree);
    const Vec3f direction(std::cos(elevation) * std::sin(orbit.azimuth), -std::sin(elevation),
                          std::cos(elevation) * std::cos(orbit.azimuth));
    // The patient frame tilts with the table, the observer does not.
    const Quatf level(Eigen::AngleAxisf(-table_angle, Vec3f::UnitX()));
    camera.up = level * camera.up;
    camera.eye = camera.target + std::clamp(orbit.distance, 0.15f, 1.5f) * (level * direction);
    camera.vertical_fov = 26.0f * degree;
    camera.far_plane = room_far;
    return camera;
}

Camera section_camera(const Section& section, const Landmarks& rest, const Landmarks& now) {
    constexpr float away = 0.5f;  // [m]
    // 120 mm of picture at term, where the gum is 50 mm from the glottis.
    constexpr float height_by_airway = 2.4f;
    constexpr float least_height = 0.05f, most_height = 0.3f;  // [m]
    const float airway = (at(rest, Landmark::upper_gum) - at(rest, Landmark::glottis)).norm();
    const float height = std::clamp(height_by_airway * airway, least_height, most_height);
    const CutPlane plane = section.plane(now);
    Camera camera;
    camera.target = plane.origin;
    camera.eye = plane.origin + away * plane.normal;
    camera.up = section.up();
    camera.vertical_fov = 2.0f * std::atan(0.5f * height / away);
    camera.near_plane = 0.2f;
    camera.far_plane = 1.0f;
    return camera;
}

Camera blade_camera(const RigidTransform& pose, const Laryngoscope& scope) {
    Camera camera;
    camera.eye = pose * blade_camera_position(scope);
    // Slightly down, so that the tip is at the picture's upper edge and the lifted tissue below.
    camera.target = camera.eye + pose.rotation * (0.03f * Vec3f(0.0f, -0.15f, 1.0f).normalized());
    camera.up = pose.rotation * Vec3f::UnitY();
    camera.vertical_fov = 75.0f * degree;
    camera.near_plane = 0.5e-3f;
    camera.far_plane = room_far;
    return camera;
}

Camera eye_camera(const view::TraineeEye& eye, const Landmarks& now, float magnification) {
    const RigidTransform pose = eye.pose(now);
    Camera camera;
    camera.eye = pose.translation;
    // The lights also need a finite target: the distance of the glottis.
    camera.target = pose * Vec3f(0.0f, 0.0f, -(camera.eye - at(now, Landmark::glottis)).norm());
    camera.up = pose.rotation * Vec3f::UnitY();
    camera.vertical_fov = 2.0f * std::atan(std::tan(13.0f * degree) / magnification);
    // The laryngoscope's handle comes close.
    camera.near_plane = 0.03f;
    camera.far_plane = room_far;
    return camera;
}

Camera headset_camera(const RigidTransform& pose, const FieldOfView& field) {
    Camera camera;
    camera.eye = pose.translation;
    camera.target = pose * Vec3f(0.0f, 0.0f, -0.3f);
    camera.up = pose.rotation * Vec3f::UnitY();
    camera.field = field;
    // The closest an eye can look.
    camera.near_plane = 0.03f;
    camera.far_plane = room_far;
    return camera;
}

Camera close_up_camera(const view::TraineeEye& eye, const Landmarks& now) {
    Camera camera = eye_camera(eye, now);
    camera.vertical_fov = 5.0f * degree;
    return camera;
}

}  // namespace eti::render
