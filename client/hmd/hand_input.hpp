// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>

#include "common/math/transform.hpp"

namespace eti::hmd {

/// A thumbstick or trackpad: -1 to 1 to the right and up.
struct Pad {
    float x = 0.0f, y = 0.0f;
    bool pressed = false;
};

/// One hand.
struct Hand {
    std::optional<RigidTransform> aim;  ///< world frame, pointing along -z; nullopt: not tracked
    float trigger = 0.0f;               ///< 0-1
};

/// Input of both hand controllers, by function. All inactive while no hand is present.
struct HandInput {
    std::array<Hand, 2> hands{};  ///< left first; the trigger controls suction, or clicks on a panel
    Pad head_and_jaw{};           ///< up and down: head; right and left: jaw
    Pad table{};                  ///< up and down: table tilt
    bool head_up = false;         ///< for controllers without a pad
    bool head_down = false;
    bool enhanced = false;
    bool panel = false;  ///< toggles the instructor's panel
};

}  // namespace eti::hmd
