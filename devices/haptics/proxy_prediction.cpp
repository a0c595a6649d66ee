// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/proxy_prediction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/pace.hpp"

namespace eti::devices {

namespace {

// Gauss-Seidel sweeps over the planes. Two planes at 60 deg converge to 1/16 in 4, more obtuse ones faster.
constexpr int sweeps = 4;

Vec3f beyond(const Vec3f& v, float most) {
    const float length = v.norm();
    return length > most ? Vec3f(v * (1.0f - most / length)) : Vec3f(Vec3f::Zero());
}

/// Remainder of `offset` after the device has moved by `way`: zero once it has moved by all of it.
Vec3f used_up(const Vec3f& offset, const Vec3f& way) {
    const float length = offset.norm();
    return length > 0.0f ? Vec3f(offset * std::clamp(1.0f - way.dot(offset) / (length * length), 0.0f, 1.0f))
                         : offset;
}

/// Projects `point` and its `velocity` to the free side of planes through `origin`.
void keep_off(std::span<const Vec3f> normals, const Vec3f& origin, Vec3f& point, Vec3f& velocity) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Vec3f& n : normals) {
            const float depth = n.dot(point - origin);
            if (depth < 0.0f) {
                point -= depth * n;
                velocity -= velocity.dot(n) * n;
            }
        }
    }
}

/// The part of `offset` that no plane explains.
Vec3f residual_offset(std::span<const Vec3f> normals, Vec3f offset) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (const Vec3f& n : normals) {
            offset -= std::max(0.0f, offset.dot(n)) * n;
        }
    }
    return offset;
}

Vec3f turn_of(const RigidTransform& to, const RigidTransform& from) {
    return rotation_vector(to.rotation * from.rotation.conjugate());
}

/// Axes of rotation that move the contacts' centre off the planes; none where the planes push through the
/// tool's origin. `axes` has as many entries as there are normals; returns the number found.
std::size_t turning_axes(const ProxyReport& report, std::span<Vec3f> axes) {
    constexpr float shortest_arm = 1e-3f;  // [m]
    const Vec3f arm = report.contact_centre - report.proxy.pose.translation;
    std::size_t count = 0;
    for (const Vec3f& n : report.contact_normals()) {
        const Vec3f axis = arm.cross(n);
        if (axis.norm() > shortest_arm) {
            axes[count++] = axis.normalized();
        }
    }
    return count;
}

}  // namespace

Speeds RecentSpeeds::update(const Motion& device, bool touching, float dt) {
    // The current speed comes first: it replaces NaN.
    const float kept = std::exp(-dt / memory_);
    recent_.moving = std::max(device.velocity.norm(), kept * recent_.moving);
    recent_.turning = std::max(device.angular_velocity.norm(), kept * recent_.turning);
    untouched_ = touching ? 0.0f : untouched_ + dt;
    return untouched_ > untouched_time_ ? recent_ : Speeds{};
}

std::optional<Motion> predicted_proxy(const Motion& device, const ProxyReport& report, float age, float pace,
                                      const PredictionBounds& bounds, const Speeds& lately, bool held) {
    // Written so that NaN is out of bounds too.
    if (!((device.pose.translation - report.device.translation).norm() <= bounds.travel)) {
        return std::nullopt;
    }
    const Vec3f way = device.pose.translation - report.device.translation;
    const Vec3f turn = turn_of(device.pose, report.device);
    Vec3f offset = report.proxy.pose.translation - report.device.translation;
    Vec3f turned = turn_of(report.proxy.pose, report.device);
    const std::span<const Vec3f> normals = report.contact_normals();
    if (normals.empty()) {
        const float step = step_duration / std::max(pace, bounds.min_real_time_factor);
        offset = beyond(offset, step * std::max(device.velocity.norm(), lately.moving));
        turned = beyond(turned, step * std::max(device.angular_velocity.norm(), lately.turning));
        if (held) {
            offset = used_up(offset, way);
            turned = used_up(turned, turn);
        }
        return Motion{
            {(quaternion_from(turned) * device.pose.rotation).normalized(), device.pose.translation + offset},
            device.velocity,
            device.angular_velocity};
    }
    // Keep the offset from the device that the planes do not explain (friction).
    offset = residual_offset(normals, offset);
    Vec3f position = device.pose.translation + (held ? used_up(offset, way) : offset);
    Vec3f velocity = device.velocity;
    keep_off(normals, report.proxy.pose.translation, position, velocity);
    const Vec3f ahead = report.proxy.angular_velocity * std::clamp(age, 0.0f, bounds.turning_time);
    const Quatf anchor = (quaternion_from(ahead) * report.proxy.pose.rotation).normalized();
    if (!held) {
        return Motion{{anchor, position}, velocity, report.proxy.angular_velocity};
    }
    std::array<Vec3f, ProxyReport::max_contacts> all;
    const std::span<const Vec3f> axes(all.data(), turning_axes(report, all));
    turned = rotation_vector(device.pose.rotation * anchor.conjugate()) +
             used_up(residual_offset(axes, turned), turn);
    Vec3f turning = device.angular_velocity;
    keep_off(axes, Vec3f::Zero(), turned, turning);
    return Motion{{(quaternion_from(turned) * anchor).normalized(), position}, velocity, turning};
}

}  // namespace eti::devices
