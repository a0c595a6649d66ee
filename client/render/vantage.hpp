// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/camera.hpp"
#include "client/view/trainee_eye.hpp"

namespace eti::render {

/// What whoever sits before the pictures has moved: by mouse, keys and options. Views draw from it.
struct Vantage {
    Orbit orbit{};           ///< of the onlooker
    view::TraineeEye eye{};  ///< the trainee's own
};

}  // namespace eti::render
