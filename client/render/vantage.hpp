// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "client/render/camera.hpp"
#include "client/render/section.hpp"
#include "client/view/annotations.hpp"
#include "client/view/trainee_eye.hpp"

namespace eti::render {

/// What whoever sits before the pictures has moved: by mouse, keys and options. Views draw from it.
struct Vantage {
    Orbit orbit{};                             ///< of the onlooker
    Section section{};                         ///< where the patient is cut
    view::TraineeEye eye{};                    ///< the trainee's own
    float fogging = 0.0f;                      ///< 0-1, of the blade's lens as the session begins
    std::vector<Camera> worn{};                ///< of a headset's eyes, left first; none without a headset
    std::optional<view::Annotation> sketch{};  ///< a mark that is being drawn, before others see it
};

}  // namespace eti::render
