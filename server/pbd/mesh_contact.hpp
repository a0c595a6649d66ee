// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/math/transform.hpp"
#include "server/pbd/friction.hpp"

namespace eti::pbd {

/// A point of a mesh that may touch an obstacle: a particle, or a point of the edge between two. Its force is
/// a multiplier that goes on from step to step (augmented Lagrangian, Alart & Curnier 1991): at rest the
/// point lies on the obstacle, and the force is what the material bears there, whatever the stiffness.
/// Nothing switches: as the force goes to zero the contact ends.
struct MeshContact {
    std::array<std::uint32_t, 2> particle = {};  ///< the edge's ends; the same twice: that particle
    float along = 0.0f;                          ///< of the way from the first to the second
    Vec3f normal = Vec3f::UnitY();               ///< unit, out of the obstacle
    float gap = 0.0f;                            ///< [m], at the predicted position; negative inside
    /// [m], of the predicted position along the obstacle, from where the point stuck; found by a step, too.
    Vec3f slip = Vec3f::Zero();
    Friction friction;
    /// [N], of the obstacle on the point; found by a step, and what the next one starts from.
    Vec3f force = Vec3f::Zero();
    float stiffness = 0.0f;  ///< [N/m], of the multiplier's penalty; from the mesh

    [[nodiscard]] bool is_edge() const { return particle[0] != particle[1]; }
    [[nodiscard]] std::array<float, 2> shares() const {
        return is_edge() ? std::array{1.0f - along, along} : std::array{1.0f, 0.0f};
    }
    [[nodiscard]] Vec3f across(const Vec3f& way) const { return way - way.dot(normal) * normal; }

    /// Finds force and slip after the point has moved by `way` [m] from its predicted position. The force
    /// never pulls, and what it holds back across stays within Coulomb's bound; what slides has no slip.
    void take(const Vec3f& way) {
        const float pressing = std::max(0.0f, force.dot(normal) - stiffness * (gap + way.dot(normal)));
        if (pressing == 0.0f) {
            force.setZero();
            slip.setZero();
            return;
        }
        const Vec3f off = across(slip + way);
        const Vec3f wanted = across(force) - stiffness * off;
        const float back = wanted.norm();
        slip = back < friction.stick * pressing ? off : Vec3f(Vec3f::Zero());
        force = pressing * normal + static_cast<float>(friction.share(back, pressing)) * wanted;
    }

    /// Whether the point acts in a step, and if so whether it sticks there.
    [[nodiscard]] bool acts() const { return force.dot(normal) > stiffness * gap; }
    [[nodiscard]] bool sticks() const {
        return across(force).norm() < friction.stick * (force.dot(normal) - stiffness * gap);
    }
    /// [N], at the predicted position. What slides is held back in the step by what last held it.
    [[nodiscard]] Vec3f load() const {
        const float pressing = force.dot(normal) - stiffness * gap;
        const Vec3f back = across(force);
        return pressing * normal +
               (sticks() ? Vec3f(back - stiffness * across(slip))
                         : Vec3f(static_cast<float>(friction.share(back.norm(), pressing)) * back));
    }
    /// What the step holds, besides: the solver's.
    enum class Held : std::uint8_t { nothing, normal, point };
    Held held = Held::nothing;
};

}  // namespace eti::pbd
