// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>

#include "common/math/transform.hpp"

namespace eti::hmd {

/// A round pad under the thumb: -1 to 1 to the right and up.
struct Pad {
    float x = 0.0f, y = 0.0f;
    bool pressed = false;
};

/// One hand.
struct Hand {
    std::optional<RigidTransform> aim;  ///< where it points from, along -z, in the world; nothing: unknown
    float trigger = 0.0f;               ///< 0-1
};

/// What both hand controllers do, by what it is meant for. All at rest while no hand is there.
struct HandInput {
    std::array<Hand, 2> hands{};  ///< left first; a trigger sucks, or clicks at what is pointed at
    Pad head_and_jaw{};           ///< up and down: the head; right and left: the jaw
    Pad table{};                  ///< up and down
    bool head_up = false;         ///< of controllers without a pad
    bool head_down = false;
    bool enhanced = false;
    bool panel = false;  ///< the instructor's, shown or hidden
};

}  // namespace eti::hmd
