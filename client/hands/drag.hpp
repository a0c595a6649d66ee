// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::client {

/// What a mouse did since it was last asked; pixels from the drawing area's upper left.
struct Drag {
    float from_x = 0.0f, from_y = 0.0f;  ///< where the button went down, or the wheel turned
    float x = 0.0f, y = 0.0f;            ///< moved by, to the right and down, with a button held
    float notches = 0.0f;                ///< of the wheel, away from oneself
    bool second = false;                 ///< the right button, not the left
    bool shift = false;                  ///< with the shift key down
    /// With the shift key a mark is drawn: when the button goes down, while it is held, when it is let go.
    enum class Mark { none, begins, goes_on, ends } mark = Mark::none;
    float at_x = 0.0f, at_y = 0.0f;  ///< where the mouse is then
};

}  // namespace eti::client
