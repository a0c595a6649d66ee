// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::hmd {

/// A round pad under the thumb: -1 to 1 to the right and up.
struct Pad {
    float x = 0.0f, y = 0.0f;
    bool pressed = false;
};

/// What both hand controllers do, by what it is meant for. All at rest while no hand is there.
struct HandInput {
    float suction = 0.0f;  ///< 0-1
    Pad head_and_jaw{};    ///< up and down: the head; right and left: the jaw
    Pad table{};           ///< up and down
    bool head_up = false;  ///< of controllers without a pad
    bool head_down = false;
    bool enhanced = false;
};

}  // namespace eti::hmd
