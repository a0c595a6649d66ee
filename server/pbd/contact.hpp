// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools.hpp"
#include "server/pbd/friction.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// A capsule that moves within a substep; end points before and after [m].
struct MovingCapsule {
    Vec3f a_before = Vec3f::Zero(), b_before = Vec3f::Zero();
    Vec3f a = Vec3f::Zero(), b = Vec3f::Zero();
    float radius = 0.0f;
};

/// Closest point of segment a-b to `point`, as its parameter in [0, 1].
[[nodiscard]] inline float closest_on_segment(const Vec3f& a, const Vec3f& b, const Vec3f& point) {
    const Vec3f along = b - a;
    const float squared = along.squaredNorm();
    return squared > 0.0f ? std::clamp((point - a).dot(along) / squared, 0.0f, 1.0f) : 0.0f;
}

/// From the closest point of segment a-b to `point` [m].
[[nodiscard]] inline Vec3f away_from(const Vec3f& a, const Vec3f& b, const Vec3f& point) {
    return point - a - closest_on_segment(a, b, point) * (b - a);
}

/// Where something that goes from `from` to `to` first comes as near as `reach` [m] to the segment a-b, by
/// sphere tracing (Hart 1996). If it is nearer from the start, others having pushed it, it starts from the
/// closest point at that distance. Nothing if it stays away.
[[nodiscard]] std::optional<Vec3f> first_contact(const Vec3f& a, const Vec3f& b, float reach,
                                                 const Vec3f& from, const Vec3f& to);

/// `point`, moved along the unit `direction` as far as it takes to be `reach` [m] from the segment a-b.
[[nodiscard]] Vec3f moved_clear(const Vec3f& a, const Vec3f& b, float reach, const Vec3f& point,
                                const Vec3f& direction);

/// Whether a tool runs head-on into what it meets where its surface faces along the unit `normal`: it is
/// `moved` [m] in this substep, farther than a thirty-second of `reach` [m], from its axis to what it meets
/// (0.2 m/s for the blade's tip and 0.1 m/s for the tube's, at 1/1440 s). What is met so is
/// pushed ahead of the tool. Pushed out by the shortest way, as is right at rest, it would slip round the
/// tool's nose before what it hangs on can follow, and the tool would pierce thin tissue.
[[nodiscard]] bool runs_head_on(const Vec3f& moved, const Vec3f& normal, float reach);

/// Pushes the predicted particle out of the capsule, with Coulomb friction against the capsule's own
/// motion: tangential slip is undone whole while it sticks, else by the kinetic coefficient times the normal
/// push (Macklin et al. 2014, eq. 24). A particle that the capsule runs into head-on, or swept over in this
/// substep, is put back to where both met. Returns the displacement given to the particle.
[[nodiscard]] Vec3f push_out_of(const MovingCapsule& capsule, const Vec3f& before, const Vec3f& predicted,
                                float radius, const Friction& friction);

/// Pushes a predicted particle out of the solid of a distance grid. Returns the displacement.
[[nodiscard]] Vec3f push_out_of(const DistanceGrid& solid, const Vec3f& before, const Vec3f& predicted,
                                float radius, const Friction& friction);

}  // namespace eti::pbd
