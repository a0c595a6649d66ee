// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/views/camera.hpp"

namespace eti::hands {

/// Displacement [m, patient frame] parallel to the picture plane that makes the point drawn at `point` [m]
/// follow the mouse: `right` and `down` pixels in a picture `height` pixels high. Points behind the camera
/// or nearer than 10 mm are treated as at 10 mm.
[[nodiscard]] Vec3f picture_displacement(const render::Camera& camera, float height, const Vec3f& point,
                                         float right, float down);

}  // namespace eti::hands
