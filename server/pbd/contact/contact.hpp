// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/closest_point.hpp"
#include "common/mesh/distance_grid.hpp"
#include "common/model/tools/tools.hpp"
#include "server/pbd/contact/friction.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// A capsule that moves within a substep; end points before and after [m].
struct MovingCapsule {
    Vec3f a_before = Vec3f::Zero(), b_before = Vec3f::Zero();
    Vec3f a = Vec3f::Zero(), b = Vec3f::Zero();
    float radius = 0.0f;
};

/// First point on the path from `from` to `to` at distance `reach` [m] from segment a-b, by sphere tracing
/// (Hart 1996). If the path starts nearer (after other pushes), it is first moved from the closest point out
/// to that distance. Empty if the path stays clear.
[[nodiscard]] std::optional<Vec3f> first_contact(const Vec3f& a, const Vec3f& b, float reach,
                                                 const Vec3f& from, const Vec3f& to);

/// Moves `point` along the unit `direction` until it is `reach` [m] from segment a-b.
[[nodiscard]] Vec3f pushed_clear(const Vec3f& a, const Vec3f& b, float reach, const Vec3f& point,
                                 const Vec3f& direction);

/// Whether a tool runs head-on into an obstacle whose surface has the unit `normal`: its displacement `moved`
/// [m] in this substep exceeds 1/32 of `reach` [m], the distance from its axis to the obstacle (0.2 m/s for
/// the blade's tip and 0.1 m/s for the tube's, at 1/1440 s).
///
/// Such an obstacle is pushed ahead of the tool. Pushed out by the shortest way, which is right at rest, it
/// would slip round the tool's tip before the tissue behind it can follow, and the tool would pierce thin
/// tissue.
[[nodiscard]] bool runs_head_on(const Vec3f& moved, const Vec3f& normal, float reach);

/// Pushes the predicted particle out of the capsule, with Coulomb friction relative to the capsule's motion.
/// Tangential slip is removed entirely while sticking, else by the kinetic coefficient times the normal push
/// (Macklin et al. 2014, eq. 24). A particle that the capsule hits head-on or sweeps over in this substep is
/// moved back to the point of impact. Returns the displacement.
[[nodiscard]] Vec3f push_out_of(const MovingCapsule& capsule, const Vec3f& before, const Vec3f& predicted,
                                float radius, const Friction& friction);

/// Pushes a predicted particle out of a distance grid's solid. Returns the displacement.
[[nodiscard]] Vec3f push_out_of(const DistanceGrid& solid, const Vec3f& before, const Vec3f& predicted,
                                float radius, const Friction& friction);

}  // namespace eti::pbd
