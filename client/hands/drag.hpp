// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::hands {

/// Mouse input since the last query; pixels from the drawing area's upper left.
struct Drag {
    float from_x = 0.0f, from_y = 0.0f;  ///< where the button was pressed, or the wheel turned
    float x = 0.0f, y = 0.0f;            ///< displacement to the right and down with a button held
    float notches = 0.0f;                ///< wheel notches, away from the user
    bool right_button = false;           ///< the right button, not the left
    bool shift = false;                  ///< shift key down
    /// Shift-drag draws a mark: button pressed, held, released.
    enum class Mark { none, begins, continues, ends } mark = Mark::none;
    float at_x = 0.0f, at_y = 0.0f;  ///< current mouse position
};

}  // namespace eti::hands
