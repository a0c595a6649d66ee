// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/hand.hpp"

#include <cmath>

namespace eti {

namespace {

/// Velocity after `dt` of a mass that a spring-damper pulls to a moving goal, by backward Euler. Spring,
/// damping and Coulomb friction are all evaluated at the end of the step. The step is therefore stable at any
/// stiffness, never adds energy, and keeps static friction. The price is a numerical damping of stiffness *
/// dt, 5 % of the hand's own at 1 ms.
Vec3f implicit_velocity(const Vec3f& velocity, const Vec3f& towards_goal, const Vec3f& goal_velocity,
                        const Vec3f& load, float mass, float stiffness, float damping, float own_damping,
                        float friction, float dt) {
    const Vec3f impulse = mass * velocity + dt * (load + stiffness * towards_goal + damping * goal_velocity);
    const float size = impulse.norm();
    if (size <= dt * friction) {
        return Vec3f::Zero();
    }
    const float inert = mass + dt * (damping + own_damping) + dt * dt * stiffness;
    return impulse * ((1.0f - dt * friction / size) / inert);
}

}  // namespace

HandDevice::HandDevice(const HandSettings& settings, const RigidTransform& start)
    : settings_(settings), motion_{start, Vec3f::Zero(), Vec3f::Zero()}, last_wanted_(start) {}

void HandDevice::step(const RigidTransform& wanted, const Wrench& wrench, float dt) {
    // A single invalid sample must not corrupt the state permanently.
    if (!(dt > 0.0f) || !is_valid_pose(wanted) || !wrench.is_finite()) {
        return;
    }
    const HandSettings& s = settings_;
    const Vec3f wanted_velocity = (wanted.translation - last_wanted_.translation) / dt;
    const Vec3f wanted_turning = rotation_vector(wanted.rotation * last_wanted_.rotation.conjugate()) / dt;
    last_wanted_ = wanted;

    motion_.velocity = implicit_velocity(motion_.velocity, wanted.translation - motion_.pose.translation,
                                         wanted_velocity, wrench.force, s.mass, s.hand_stiffness,
                                         s.hand_damping, s.device_damping, s.friction, dt);
    motion_.pose.translation += dt * motion_.velocity;

    motion_.angular_velocity = implicit_velocity(
        motion_.angular_velocity, rotation_vector(wanted.rotation * motion_.pose.rotation.conjugate()),
        wanted_turning, wrench.torque, s.inertia, s.hand_rotational_stiffness, s.hand_rotational_damping,
        s.device_rotational_damping, 0.0f, dt);
    motion_.pose.rotation =
        (quaternion_from(dt * motion_.angular_velocity) * motion_.pose.rotation).normalized();
}

RigidTransform HandDevice::reported() const {
    RigidTransform pose = motion_.pose;
    if (settings_.encoder_step > 0.0f) {
        pose.translation =
            (pose.translation / settings_.encoder_step).array().round() * settings_.encoder_step;
    }
    return pose;
}

}  // namespace eti
