// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/passivity.hpp"

#include <algorithm>

namespace eti::devices {

namespace {

double work(const Wrench& wrench, const Vec3f& way, const Vec3f& turn) {
    return static_cast<double>(wrench.force.dot(way) + wrench.torque.dot(turn));
}

}  // namespace

Wrench PassivityController::apply(const Wrench& wanted, const Motion& device, float dt, bool steady) {
    if (any_) {
        const Vec3f way = device.pose.translation - pose_.translation;
        const Vec3f turn = rotation_vector(device.pose.rotation * pose_.rotation.conjugate());
        stored_ = std::min(stored_ - work(last_, way, turn), static_cast<double>(settings_.max_stored));
        dissipated_ -= work(damping_, way, turn);
        lowest_ = std::min(lowest_, stored_);
    }
    any_ = true;
    pose_ = device.pose;
    idle_ =
        wanted.force.norm() + wanted.torque.norm() / settings_.arm < settings_.idle_force ? idle_ + dt : 0.0f;
    if (idle_ > settings_.idle_time) {
        stored_ = 0.0;
    }
    if (!steady) {
        stored_ = std::max(stored_, 0.0);
    }
    damping_ = {};
    const float arm2 = settings_.arm * settings_.arm;
    const float speed2 = device.velocity.squaredNorm() + arm2 * device.angular_velocity.squaredNorm();
    if (settings_.on && stored_ < 0.0 && speed2 > 0.0f && dt > 0.0f) {
        const float damping = std::min(static_cast<float>(-stored_) / (dt * speed2), settings_.max_damping);
        damping_ = {-damping * device.velocity, -damping * arm2 * device.angular_velocity};
        ++active_;
    }
    last_ = {wanted.force + damping_.force, wanted.torque + damping_.torque};
    return last_;
}

}  // namespace eti::devices
