// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/picture_plane.hpp"

#include <algorithm>
#include <cmath>

namespace eti::hands {
namespace {

constexpr float nearest = 0.01f;  // [m]

}  // namespace

Vec3f picture_displacement(const render::Camera& camera, float height, const Vec3f& point, float right,
                           float down) {
    const RigidTransform pose = camera.pose();
    const float depth = std::max(nearest, -(pose.inverse() * point).z());
    // Pixels are square, so one scale serves both directions.
    const float per_pixel = 2.0f * depth * std::tan(0.5f * camera.vertical_fov) / height;
    return pose.rotation * Vec3f(per_pixel * right, -per_pixel * down, 0.0f);
}

}  // namespace eti::hands
