// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "client/render/views/camera.hpp"
#include "client/render/views/section.hpp"
#include "client/view/annotations.hpp"
#include "client/view/sight/trainee_eye.hpp"

namespace eti::render {

/// View parameters that the user sets by mouse, keys and options.
struct Vantage {
    Orbit orbit{};                            ///< of the observer
    Section section{};                        ///< section plane
    view::TraineeEye eye{};                   ///< the trainee's own
    bool hands = true;                        ///< whether hands hold the tools in views from outside
    float fogging = 0.0f;                     ///< 0-1, initial fogging of the blade's lens
    std::vector<Camera> headset_eyes{};       ///< the headset's eyes, left first; empty without a headset
    std::optional<bus::Annotation> sketch{};  ///< a mark being drawn, not visible to others yet
};

}  // namespace eti::render
