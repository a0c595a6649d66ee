// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// A capsule that moves within a substep; end points before and after [m].
struct MovingCapsule {
    Vec3f a_before = Vec3f::Zero(), b_before = Vec3f::Zero();
    Vec3f a = Vec3f::Zero(), b = Vec3f::Zero();
    float radius = 0.0f;
};

/// Closest point of segment a-b to `point`, as its parameter in [0, 1].
[[nodiscard]] float closest_on_segment(const Vec3f& a, const Vec3f& b, const Vec3f& point);

/// Pushes the predicted particle out of the capsule, with Coulomb friction against the capsule's own
/// motion: tangential slip up to `friction` times the normal push is undone (Macklin et al. 2014,
/// eq. 24). A particle that the capsule swept over in this substep is put back on the side it came
/// from. Returns the displacement given to the particle.
[[nodiscard]] Vec3f push_out_of(const MovingCapsule& capsule, const Vec3f& before, const Vec3f& predicted,
                                float radius, float friction);

/// Pushes a predicted particle out of the solid of a distance grid. Returns the displacement.
[[nodiscard]] Vec3f push_out_of(const DistanceGrid& solid, const Vec3f& before, const Vec3f& predicted,
                                float radius, float friction);

}  // namespace eti::pbd
