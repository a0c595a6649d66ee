// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/proxy_prediction.hpp"

#include <algorithm>
#include <cmath>

namespace eti::devices {

namespace {

// Sweeps over the planes. Two planes at 60 deg reach the corner to 1/16 in 4, more obtuse ones faster.
constexpr int sweeps = 4;
constexpr float simulation_step = 1.0f / 180.0f;  // [s]

Vec3f beyond(const Vec3f& v, float most) {
    const float length = v.norm();
    return length > most ? Vec3f(v * (1.0f - most / length)) : Vec3f(Vec3f::Zero());
}

}  // namespace

Speeds RecentSpeeds::update(const Motion& device, bool touching, float dt) {
    // The present speed first: it takes the place of one that is not a number.
    const float kept = std::exp(-dt / memory_);
    recent_.moving = std::max(device.velocity.norm(), kept * recent_.moving);
    recent_.turning = std::max(device.angular_velocity.norm(), kept * recent_.turning);
    untouched_ = touching ? 0.0f : untouched_ + dt;
    return untouched_ > untouched_time_ ? recent_ : Speeds{};
}

std::optional<Motion> predicted_proxy(const Motion& device, const ProxyReport& report, float age, float pace,
                                      const PredictionBounds& bounds, const Speeds& lately) {
    // Written so that not-a-number is out of bounds too.
    if (!((device.pose.translation - report.device.translation).norm() <= bounds.travel)) {
        return std::nullopt;
    }
    const std::span<const Vec3f> normals = report.contact_normals();
    if (normals.empty()) {
        const float step = simulation_step / std::max(pace, bounds.slowest_pace);
        const Vec3f trailing = beyond(report.proxy.pose.translation - report.device.translation,
                                      step * std::max(device.velocity.norm(), lately.moving));
        const Vec3f turned =
            beyond(rotation_vector(report.proxy.pose.rotation * report.device.rotation.conjugate()),
                   step * std::max(device.angular_velocity.norm(), lately.turning));
        return Motion{{(quaternion_from(turned) * device.pose.rotation).normalized(),
                       device.pose.translation + trailing},
                      device.velocity,
                      device.angular_velocity};
    }
    // What holds the proxy off the device besides the planes (friction) is kept.
    Vec3f offset = report.proxy.pose.translation - report.device.translation;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Vec3f& n : normals) {
            offset -= std::max(0.0f, offset.dot(n)) * n;
        }
    }
    Vec3f position = device.pose.translation + offset;
    Vec3f velocity = device.velocity;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Vec3f& n : normals) {
            const float depth = n.dot(position - report.proxy.pose.translation);
            if (depth < 0.0f) {
                position -= depth * n;
                velocity -= velocity.dot(n) * n;
            }
        }
    }
    const Vec3f turn = report.proxy.angular_velocity * std::clamp(age, 0.0f, bounds.turning_time);
    return Motion{{(quaternion_from(turn) * report.proxy.pose.rotation).normalized(), position},
                  velocity,
                  report.proxy.angular_velocity};
}

}  // namespace eti::devices
