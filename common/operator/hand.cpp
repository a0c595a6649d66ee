// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/hand.hpp"

#include <algorithm>
#include <cmath>

namespace eti {

namespace {

Vec3f shortened(const Vec3f& v, float most) {
    const float length = v.norm();
    return length > most ? Vec3f(v * (most / length)) : v;
}

/// Velocity after `dt` of a mass on a spring-damper to a moving goal, with the spring and all damping
/// implicit: stable for any stiffness.
Vec3f implicit_velocity(const Vec3f& velocity, const Vec3f& towards_goal, const Vec3f& goal_velocity, const Vec3f& load,
                        float mass, float stiffness, float damping, float own_damping, float dt) {
    const Vec3f impulse = mass * velocity + dt * (load + stiffness * towards_goal + damping * goal_velocity);
    return impulse / (mass + dt * (damping + own_damping) + dt * dt * stiffness);
}

}  // namespace

Wrench coupling_wrench(const Motion& device, const Motion& proxy, const CouplingSettings& settings) {
    const Vec3f turn = rotation_vector(proxy.pose.rotation * device.pose.rotation.conjugate());
    return {settings.stiffness * (proxy.pose.translation - device.pose.translation) +
                settings.damping * (proxy.velocity - device.velocity),
            settings.rotational_stiffness * turn +
                settings.rotational_damping * (proxy.angular_velocity - device.angular_velocity)};
}

Wrench limited(const Wrench& wrench, const CouplingSettings& settings) {
    if (!wrench.force.allFinite() || !wrench.torque.allFinite()) {
        return {};
    }
    return {shortened(wrench.force, settings.force_limit), shortened(wrench.torque, settings.torque_limit)};
}

HandDevice::HandDevice(const HandSettings& settings, const RigidTransform& start)
    : settings_(settings), motion_{start, Vec3f::Zero(), Vec3f::Zero()}, last_wanted_(start) {}

void HandDevice::step(const RigidTransform& wanted, const Wrench& wrench, float dt) {
    const HandSettings& s = settings_;
    const Vec3f wanted_velocity = (wanted.translation - last_wanted_.translation) / dt;
    const Vec3f wanted_turning = rotation_vector(wanted.rotation * last_wanted_.rotation.conjugate()) / dt;
    last_wanted_ = wanted;

    Vec3f velocity = implicit_velocity(motion_.velocity, wanted.translation - motion_.pose.translation, wanted_velocity,
                                       wrench.force, s.mass, s.hand_stiffness, s.hand_damping, s.device_damping, dt);
    // Coulomb friction takes at most the velocity there is.
    const float speed = velocity.norm();
    const float held = s.friction * dt / s.mass;
    velocity = speed > held ? Vec3f(velocity * ((speed - held) / speed)) : Vec3f(Vec3f::Zero());
    motion_.velocity = velocity;
    motion_.pose.translation += dt * velocity;

    motion_.angular_velocity = implicit_velocity(
        motion_.angular_velocity, rotation_vector(wanted.rotation * motion_.pose.rotation.conjugate()), wanted_turning,
        wrench.torque, s.inertia, s.hand_rotational_stiffness, s.hand_rotational_damping, s.device_rotational_damping, dt);
    motion_.pose.rotation = (quaternion_from(dt * motion_.angular_velocity) * motion_.pose.rotation).normalized();
}

RigidTransform HandDevice::reported() const {
    RigidTransform pose = motion_.pose;
    if (settings_.encoder_step > 0.0f) {
        pose.translation = (pose.translation / settings_.encoder_step).array().round() * settings_.encoder_step;
    }
    return pose;
}

}  // namespace eti
