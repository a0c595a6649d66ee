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

/// Magnification of the trainee's eye by a loupe; 1: without. Surgical loupes magnify 2 to 6 times.
struct Loupe {
    static constexpr float max_magnification = 8.0f, usual_magnification = 4.0f;

    float magnification = 1.0f;

    [[nodiscard]] bool on() const { return magnification > 1.0f; }
    /// Takes the loupe off, or puts it on as last used.
    void toggle();
    /// While on, by a factor for each notch of the wheel; never off.
    void turn_wheel(float notches);

  private:
    float worn_ = usual_magnification;
};

/// View parameters that the user sets by mouse, keys and options.
struct Vantage {
    Orbit orbit{};                            ///< of the observer
    Section section{};                        ///< section plane
    view::TraineeEye eye{};                   ///< the trainee's own
    Loupe loupe{};                            ///< before the trainee's eye; does not move it
    bool hands = true;                        ///< whether hands hold the tools in views from outside
    float fogging = 0.0f;                     ///< 0-1, initial fogging of the blade's lens
    std::vector<Camera> headset_eyes{};       ///< the headset's eyes, left first; empty without a headset
    std::optional<bus::Annotation> sketch{};  ///< a mark being drawn, not visible to others yet
};

}  // namespace eti::render
