// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "common/math/transform.hpp"
#include "server/pbd/contact/friction.hpp"

namespace eti::pbd {

/// A point of a mesh that may touch an obstacle: a particle, or a point on an edge or face; or a particle
/// that may touch a point within another part of the mesh, whose corners have negative shares. Its force is a
/// multiplier that persists from step to step (augmented Lagrangian, Alart & Curnier 1991). At equilibrium
/// the point lies on the obstacle and the force is the material's reaction, whatever the stiffness. Contact
/// ends without switching, as the force goes to zero.
struct MeshContact {
    static constexpr std::size_t max_corners = 5;

    std::array<std::uint32_t, max_corners> particle = {};  ///< the first `corners` are used
    std::array<float, max_corners> share = {1.0f};         ///< their weights, which sum to 1, or to 0
                                                           ///< within the mesh
    std::uint8_t corners = 1;
    bool within_mesh = false;
    std::int32_t far_end = fixed_end;  ///< the obstacle's Jacobian, if a body carries it: see YieldingBodies
    static constexpr std::int32_t fixed_end = -1;
    float damping = 0.0f;           ///< of its displacement, in `stiffness`; changes no equilibrium
    Vec3f normal = Vec3f::UnitY();  ///< unit, out of the obstacle
    float gap = 0.0f;               ///< [m], at the predicted position; negative inside
    /// [m], tangential displacement of the predicted position from where the point stuck; updated by each
    /// step.
    Vec3f slip = Vec3f::Zero();
    Friction friction;
    /// [N], of the obstacle on the point; result of a step and initial value of the next.
    Vec3f force = Vec3f::Zero();
    float stiffness = 0.0f;  ///< [N/m], penalty of the multiplier; set from the mesh
    /// Of the penalty of a point that stands for a particle's whole surface; less where several points do.
    float area_share = 1.0f;

    [[nodiscard]] static MeshContact at_particle(std::uint32_t index) {
        MeshContact contact;
        contact.particle[0] = index;
        return contact;
    }
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return {particle.data(), corners}; }
    [[nodiscard]] std::span<const float> shares() const { return {share.data(), corners}; }
    [[nodiscard]] Vec3f across(const Vec3f& displacement) const {
        return displacement - displacement.dot(normal) * normal;
    }

    /// Updates force and slip for a displacement [m] from the predicted position, relative to that of the
    /// obstacle. The normal force never pulls; the tangential force stays within Coulomb's bound. A sliding
    /// point has no slip.
    void update(const Vec3f& displacement) {
        const float pressing =
            std::max(0.0f, force.dot(normal) - stiffness * (gap + displacement.dot(normal)));
        if (pressing == 0.0f) {
            force.setZero();
            slip.setZero();
            return;
        }
        const Vec3f off = across(slip + displacement);
        const Vec3f wanted = across(force) - stiffness * off;
        const float back = wanted.norm();
        slip = back < friction.static_coefficient * pressing ? off : Vec3f(Vec3f::Zero());
        force = pressing * normal + static_cast<float>(friction.share(back, pressing)) * wanted;
    }

    /// Whether the contact is active in a step, and whether it sticks.
    [[nodiscard]] bool is_active() const { return force.dot(normal) > stiffness * gap; }
    [[nodiscard]] bool sticks() const {
        return across(force).norm() < friction.static_coefficient * (force.dot(normal) - stiffness * gap);
    }
    /// [N], at the predicted position. While sliding, the last tangential force acts in the step.
    [[nodiscard]] Vec3f load() const {
        const float pressing = force.dot(normal) - stiffness * gap;
        const Vec3f back = across(force);
        return pressing * normal +
               (sticks() ? Vec3f(back - stiffness * across(slip))
                         : Vec3f(static_cast<float>(friction.share(back.norm(), pressing)) * back));
    }
    /// [N/m], of the held degrees of freedom within a step.
    [[nodiscard]] float holding_stiffness() const { return stiffness * (1.0f + damping); }
    /// The degrees of freedom that the step constrains; used by the solver.
    enum class Held : std::uint8_t { nothing, normal, point };
    Held held = Held::nothing;
};

}  // namespace eti::pbd
