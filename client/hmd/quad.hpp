// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/math/transform.hpp"

namespace eti::hmd {

/// A flat quad in the room showing one colour picture: its pose in the world and its size [m]. Its front
/// faces the pose's +z; +x is to the right and +y up.
struct Quad {
    RigidTransform pose;
    float width = 0.0f, height = 0.0f;
};

/// Intersection of a ray with a panel's plane: fractions of its width and height from the upper left,
/// outside 0-1 beyond its edges.
struct QuadHit {
    float across = 0.0f, down = 0.0f;
    float distance = 0.0f;  ///< [m] from the start of the ray
    [[nodiscard]] bool inside() const {
        return across >= 0.0f && across <= 1.0f && down >= 0.0f && down <= 1.0f;
    }
};

/// `aim`: the hand's aim pose, pointing along -z (OpenXR 1.0, 6.3.2). nullopt if it misses the plane or
/// hits its back.
[[nodiscard]] std::optional<QuadHit> intersect_quad(const Quad& panel, const RigidTransform& aim);

}  // namespace eti::hmd
