// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/math/transform.hpp"

namespace eti::hmd {

/// A flat sheet in the room, of one colour picture: where it hangs in the world and how wide it is [m]. Its
/// front looks along its pose's +z, +x is to the right and +y up.
struct Panel {
    RigidTransform pose;
    float width = 0.0f, height = 0.0f;
};

/// Where a straight line meets a panel's plane: shares of its width and height from its upper left, beyond 0
/// and 1 outside of it.
struct Pointed {
    float across = 0.0f, down = 0.0f;
    float distance = 0.0f;  ///< [m] from where the line begins
    [[nodiscard]] bool inside() const {
        return across >= 0.0f && across <= 1.0f && down >= 0.0f && down <= 1.0f;
    }
};

/// `aim`: where a hand points from, along its -z (OpenXR 1.0, 6.3.2). Nothing where it points beside the
/// plane or at its back.
[[nodiscard]] std::optional<Pointed> pointed_at(const Panel& panel, const RigidTransform& aim);

}  // namespace eti::hmd
