// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/math/transform.hpp"
#include "common/model/tissue.hpp"

namespace eti {

/// Force [N] and torque [N m] about the tool's origin.
struct Wrench {
    Vec3f force = Vec3f::Zero();
    Vec3f torque = Vec3f::Zero();
};

/// Pose with linear [m/s] and angular [rad/s] velocity of the tool's origin.
struct Motion {
    RigidTransform pose;
    Vec3f velocity = Vec3f::Zero();
    Vec3f angular_velocity = Vec3f::Zero();
};

/// The spring-damper between device and proxy, and the limits of the device.
struct CouplingSettings {
    float stiffness = 800.0f;           ///< [N/m]
    float damping = 2.0f;               ///< [N s/m]
    float rotational_stiffness = 1.5f;  ///< [N m/rad]
    float rotational_damping = 4e-3f;   ///< [N m s/rad]
    float tissue_gain = 1.0f;           ///< share of the tissue's force that reaches the hand
    float force_limit = 7.9f;           ///< [N], device range (Touch X: 7.9 N)
    float torque_limit = 0.3f;          ///< [N m]
    float force_rate_limit = 600.0f;    ///< [N/s]
};

/// Wrench on the device from the proxy that the shell holds back (virtual coupling, Colgate 1995).
[[nodiscard]] Wrench coupling_wrench(const Motion& device, const Motion& proxy,
                                     const CouplingSettings& settings);

/// Shortens force and torque to the device's limits; a wrench that is not finite becomes zero.
[[nodiscard]] Wrench limited(const Wrench& wrench, const CouplingSettings& settings);

/// The moving part of a haptic device and the hand that holds it.
struct HandSettings {
    float mass = 0.15f;                       ///< [kg], device and laryngoscope as felt at the grip
    float inertia = 1.5e-4f;                  ///< [kg m^2], isotropic
    float device_damping = 1.0f;              ///< [N s/m]
    float device_rotational_damping = 1e-3f;  ///< [N m s/rad]
    float friction = 0.05f;                   ///< [N], Coulomb
    float encoder_step = 0.03e-3f;            ///< [m], of the reported position
    float hand_stiffness = 900.0f;            ///< [N/m], of a firm grip towards where the hand wants to be
    float hand_damping = 18.0f;               ///< [N s/m]
    float hand_rotational_stiffness = 4.0f;   ///< [N m/rad]
    float hand_rotational_damping = 0.03f;    ///< [N m s/rad]
};

/// Simulated device held by a hand: the hand pulls towards the pose it wants through its impedance,
/// so a script can ask for a pose and never dictate a force.
class HandDevice {
  public:
    HandDevice(const HandSettings& settings, const RigidTransform& start);

    /// Advances by `dt` [s] (at most 2 ms) under the hand's pull to `wanted` and the device's `wrench`.
    void step(const RigidTransform& wanted, const Wrench& wrench, float dt);

    [[nodiscard]] const Motion& motion() const { return motion_; }
    /// Pose as the encoders report it.
    [[nodiscard]] RigidTransform reported() const;

  private:
    HandSettings settings_;
    Motion motion_;
    RigidTransform last_wanted_;
};

}  // namespace eti
