// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/coupling.hpp"

namespace eti {

/// The moving part of a haptic device and the hand that holds it.
struct HandSettings {
    float mass = 0.15f;                       ///< [kg], device and laryngoscope as felt at the grip
    float inertia = 1.5e-4f;                  ///< [kg m^2], isotropic
    float device_damping = 1.0f;              ///< [N s/m]
    float device_rotational_damping = 1e-3f;  ///< [N m s/rad]
    float friction = 0.05f;                   ///< [N], Coulomb
    float encoder_step = 0.03e-3f;            ///< [m], of the reported position
    float hand_stiffness = 900.0f;            ///< [N/m], of a firm grip towards the wanted pose
    float hand_damping = 18.0f;               ///< [N s/m]
    float hand_rotational_stiffness = 4.0f;   ///< [N m/rad]
    float hand_rotational_damping = 0.03f;    ///< [N m s/rad]
};

/// Simulated haptic device held by a hand. The hand pulls towards its wanted pose through its impedance: a
/// script prescribes poses, never forces.
class HandDevice {
  public:
    HandDevice(const HandSettings& settings, const RigidTransform& start);

    /// Advances by `dt` [s] (at most 2 ms) under the hand's pull towards `wanted` and the device's `wrench`.
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
