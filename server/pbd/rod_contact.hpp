// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "server/pbd/friction.hpp"
#include "server/pbd/rod_joint.hpp"

namespace eti::pbd {

/// A point of the rod near an obstacle, as found at the rod's present pose. Contact is an implicit
/// spring, solved together with the chain: its cost does not depend on how many there are, and its
/// force is right within a pass or two however light the segment. An obstacle that is itself a
/// particle of inverse mass w [1/kg] yields by w dt^2 times the force; it is the caller who moves it.
struct RodContact {
    std::uint32_t segment = 0;
    float along = 0.5f;             ///< 0 (rear) .. 1 (front)
    Vec3f offset = Vec3f::Zero();   ///< [m], from the centre line to the point that touches
    Vec3f normal = Vec3f::UnitY();  ///< unit, from the obstacle to the rod
    float gap = 0.0f;               ///< [m]; negative: overlap
    Vec3f slip = Vec3f::Zero();     ///< [m], way of the point along the obstacle in this substep so far
    float stiffness = 3000.0f;      ///< [N/m]; overlap at rest is force over stiffness
    float yielding = 0.0f;          ///< [m/N], how far the obstacle gives way within this substep
    /// [N/m], symmetric, not negative: by how much the force turns as the point moves. It steadies the
    /// search for the rod's pose and exerts nothing itself.
    Eigen::Matrix3f turning = Eigen::Matrix3f::Zero();
    Friction friction;
    /// [N], of the obstacle on the rod: what the last pass found, and what the next one starts from.
    /// Zero for a new contact; keep it from pass to pass and from substep to substep for one that
    /// goes on, else friction has nothing to go by.
    Vec3f force = Vec3f::Zero();
};

/// Contacts of one segment, linearised: what they add to its mass matrix and to its impulse.
struct RodContactSystem {
    Mat6d mass = Mat6d::Zero();     ///< [kg, kg m, kg m^2], stiffness times dt^2
    Vec6d impulse = Vec6d::Zero();  ///< [kg m, kg m^2]
};

/// Whether a contact acts in the next pass: it overlaps, or presses harder than its gap relieves (the
/// primal-dual active set of Hintermueller, Ito & Kunisch 2002).
[[nodiscard]] bool acts(const RodContact& contact);

/// Adds a contact at `arm` [m] from the segment's origin. Along the normal a spring; across it Coulomb
/// friction by augmented multipliers (Alart & Curnier 1991): the last force less `grip` times slip
/// either stays within the last pass's bound, and the point sticks, or is cut to it, and it slides.
/// `grip` [N/m] has to stay near the segment's mass over dt^2: stiffer, and a point that overshoots its
/// stop by a hair is thrown back with the full bound. Both springs are in series with what yields.
void add_contact(const RodContact& contact, const Vec3d& arm, double grip, double dt,
                 RodContactSystem& system);

/// Force [N] after the segment has moved by `motion` (displacement, rotation); never pulls, and its
/// tangential part stays within the bound.
[[nodiscard]] Vec3f contact_force(const RodContact& contact, const Vec3d& arm, double grip,
                                  const Vec6d& motion);

}  // namespace eti::pbd
