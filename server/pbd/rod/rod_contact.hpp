// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "server/pbd/contact/friction.hpp"
#include "server/pbd/rod/rod_joint.hpp"

namespace eti::pbd {

/// A point of the rod near an obstacle, at the rod's current pose. Contacts are implicit springs, solved
/// together with the chain: the number of passes does not depend on their number, and forces converge in one
/// or two passes however light the segment. An obstacle that is itself a particle of inverse mass w [1/kg]
/// has compliance w dt^2; the caller moves it.
struct RodContact {
    std::uint32_t segment = 0;
    float along = 0.5f;             ///< 0 (rear) .. 1 (front)
    Vec3f offset = Vec3f::Zero();   ///< [m], from the centre line to the contact point
    Vec3f normal = Vec3f::UnitY();  ///< unit, from the obstacle to the rod
    float gap = 0.0f;               ///< [m]; negative: overlap
    Vec3f slip = Vec3f::Zero();     ///< [m], tangential displacement of the point relative to the obstacle in
                                    ///< this substep
    float stiffness = 3000.0f;      ///< [N/m]; static overlap is force over stiffness
    float compliance = 0.0f;        ///< [m/N], of the obstacle within this substep
    /// [N/m], symmetric, positive semi-definite: rotation of the force as the point moves. It stabilizes the
    /// Newton step and exerts no force itself.
    Eigen::Matrix3f geometric_stiffness = Eigen::Matrix3f::Zero();
    Friction friction;
    /// [N], of the obstacle on the rod: result of the last pass and initial value of the next. Zero for a new
    /// contact. Keep it from pass to pass and substep to substep for a persistent contact: friction builds on
    /// it.
    Vec3f force = Vec3f::Zero();
};

/// Contacts of one segment, linearised: their contributions to its mass matrix and impulse.
struct RodContactSystem {
    Mat6d mass = Mat6d::Zero();     ///< [kg, kg m, kg m^2], stiffness times dt^2
    Vec6d impulse = Vec6d::Zero();  ///< [kg m, kg m^2]
};

/// Whether a contact is active in the next pass: it overlaps, or its force exceeds stiffness times gap
/// (primal-dual active set, Hintermueller, Ito & Kunisch 2002).
[[nodiscard]] bool is_active(const RodContact& contact);

/// Adds a contact at `arm` [m] from the segment's origin: a spring along the normal, and Coulomb friction by
/// augmented multipliers (Alart & Curnier 1991). The last tangential force less `grip` times slip either
/// stays within the last pass's bound (sticking) or is clamped to it (sliding).
///
/// `grip` [N/m] must be near the segment's mass over dt^2: if it is stiffer, a point that slightly overshoots
/// its stop is pushed back with the full bound. Both springs are in series with the obstacle's compliance.
void add_contact(const RodContact& contact, const Vec3d& arm, double grip, double dt,
                 RodContactSystem& system);

/// Force [N] after the segment has moved by `motion` (displacement, rotation). It never pulls; its tangential
/// part stays within the bound.
[[nodiscard]] Vec3f contact_force(const RodContact& contact, const Vec3d& arm, double grip,
                                  const Vec6d& motion);

}  // namespace eti::pbd
