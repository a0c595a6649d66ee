// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti {

/// Force [N] and torque [N m] about the tool's origin.
struct Wrench {
    Vec3f force = Vec3f::Zero();
    Vec3f torque = Vec3f::Zero();

    [[nodiscard]] bool is_finite() const { return force.allFinite() && torque.allFinite(); }
};

/// Pose with linear [m/s] and angular [rad/s] velocity of the tool's origin.
struct Motion {
    RigidTransform pose;
    Vec3f velocity = Vec3f::Zero();
    Vec3f angular_velocity = Vec3f::Zero();
};

/// Virtual coupling between device and proxy (spring and damper), and the device's limits.
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

/// Wrench [N, N m] that the virtual coupling to the constrained proxy applies to the device (Colgate 1995).
[[nodiscard]] Wrench coupling_wrench(const Motion& device, const Motion& proxy,
                                     const CouplingSettings& settings);

/// Limits force and torque to the device's range, keeping their direction. Returns zero for a non-finite
/// wrench.
[[nodiscard]] Wrench clamp_to_limits(const Wrench& wrench, const CouplingSettings& settings);

}  // namespace eti
