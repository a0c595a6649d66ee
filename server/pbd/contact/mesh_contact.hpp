// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/math/transform.hpp"
#include "server/pbd/contact/friction.hpp"

namespace eti::pbd {

/// A point of a mesh that may touch an obstacle: a particle, or a point on the edge between two. Its force is
/// a multiplier that persists from step to step (augmented Lagrangian, Alart & Curnier 1991). At equilibrium
/// the point lies on the obstacle and the force is the material's reaction, whatever the stiffness. Contact
/// ends without switching, as the force goes to zero.
struct MeshContact {
    std::array<std::uint32_t, 2> particle = {};  ///< ends of the edge; equal: a single particle
    float along = 0.0f;                          ///< position on the edge, from the first (0) to the second
                                                 ///< (1)
    Vec3f normal = Vec3f::UnitY();               ///< unit, out of the obstacle
    float gap = 0.0f;                            ///< [m], at the predicted position; negative inside
    /// [m], tangential displacement of the predicted position from where the point stuck; updated by each
    /// step.
    Vec3f slip = Vec3f::Zero();
    Friction friction;
    /// [N], of the obstacle on the point; result of a step and initial value of the next.
    Vec3f force = Vec3f::Zero();
    float stiffness = 0.0f;  ///< [N/m], penalty of the multiplier; set from the mesh

    [[nodiscard]] bool is_edge() const { return particle[0] != particle[1]; }
    [[nodiscard]] std::array<float, 2> shares() const {
        return is_edge() ? std::array{1.0f - along, along} : std::array{1.0f, 0.0f};
    }
    [[nodiscard]] Vec3f across(const Vec3f& displacement) const {
        return displacement - displacement.dot(normal) * normal;
    }

    /// Updates force and slip for a displacement [m] from the predicted position. The normal force never
    /// pulls; the tangential force stays within Coulomb's bound. A sliding point has no slip.
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
    /// The degrees of freedom that the step constrains; used by the solver.
    enum class Held : std::uint8_t { nothing, normal, point };
    Held held = Held::nothing;
};

}  // namespace eti::pbd
