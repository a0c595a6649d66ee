// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/camera.hpp"

namespace eti::client {

/// The move [m, patient frame] in the plane of a picture that carries what is drawn at `point` [m] along with
/// a mouse: so many pixels to the right and down in a picture `height` pixels high. What lies nearer than
/// 10 mm before the camera, or behind it, counts as so far.
[[nodiscard]] Vec3f in_picture(const render::Camera& camera, float height, const Vec3f& point, float right,
                               float down);

}  // namespace eti::client
