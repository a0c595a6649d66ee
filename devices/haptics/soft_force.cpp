// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/soft_force.hpp"

#include <algorithm>

#include "common/mesh/closest_point.hpp"

namespace eti::devices {

const std::array<float, tissue_count>& tissue_stiffness() {
    static constexpr float per_pascal = 10e-3f * 30e-3f / 15e-3f;  // A / L [m]
    static constexpr float soft = 8.0e3f * per_pascal;
    static constexpr float larynx = 8.6e3f * per_pascal;
    static constexpr std::array<float, tissue_count> table = {
        /* soft */ soft,       /* tongue */ soft,  /* epiglottis */ soft,
        /* larynx */ larynx,   /* trachea */ soft,
        /* oesophagus */ soft, /* upper gum */ 0,  /* lower gum */ 0,
        /* palate */ 0,        /* skull */ 0,
        /* mandible */ 0,      /* spine */ 0};
    return table;
}

bool touches(const TissuePoint& point, std::span<const Capsule> blade, const RigidTransform& pose) {
    const Vec3f local = pose.rotation.conjugate() * (point.position - pose.translation);
    return std::ranges::any_of(blade, [&](const Capsule& capsule) {
        const float reach = capsule.radius + point.radius;
        return offset_from_segment(capsule.a, capsule.b, local).squaredNorm() <= reach * reach;
    });
}

Wrench displacement_wrench(std::span<const TissuePoint> points, std::span<const Capsule> blade,
                           const RigidTransform& pose, const std::array<float, tissue_count>& stiffness) {
    struct Sum {
        Vec3f displacement = Vec3f::Zero();
        Vec3f position = Vec3f::Zero();
        int count = 0;
    };
    std::array<Sum, tissue_count> sums{};
    for (const TissuePoint& point : points) {
        const auto type = static_cast<std::size_t>(point.tissue);
        if (stiffness[type] > 0.0f && touches(point, blade, pose)) {
            sums[type].displacement += point.rest - point.position;
            sums[type].position += point.position;
            ++sums[type].count;
        }
    }
    Wrench total;
    int types = 0;
    for (std::size_t type = 0; type < tissue_count; ++type) {
        const Sum& sum = sums[type];
        if (sum.count == 0) {
            continue;
        }
        ++types;
        const Vec3f force = stiffness[type] * sum.displacement / static_cast<float>(sum.count);
        total.force += force;
        total.torque += (sum.position / static_cast<float>(sum.count) - pose.translation).cross(force);
    }
    if (types > 0) {
        total.force /= static_cast<float>(types);
        total.torque /= static_cast<float>(types);
    }
    return total;
}

Wrench constraint_wrench(const TissueReport& report, const RigidTransform& pose) {
    // [m], a smaller displacement does not determine stiffness: half of a small particle.
    constexpr float least_displacement = 0.5e-3f;
    Wrench out = report.wrench;
    const RigidTransform step = pose * report.proxy.inverse();
    for (const TissuePoint& point : report.touching()) {
        const float force = point.force.norm();
        if (force <= 0.0f) {
            continue;
        }
        const Vec3f way = step * point.position - point.position;
        const float deeper = -point.force.dot(way) / force;
        const float displacement = std::max((point.rest - point.position).norm(), least_displacement);
        const Vec3f change = std::clamp(deeper / displacement, -1.0f, 1.0f) * report.represents * point.force;
        out.force += change;
        out.torque += (point.position - report.proxy.translation).cross(change);
    }
    return out;
}

Wrench SmoothSoftForce::update(const Wrench& wanted, std::int64_t arrived, float over, float dt) {
    if (arrived != arrived_) {
        arrived_ = arrived;
        lacking_ = {last_.force - wanted.force, last_.torque - wanted.torque};
        left_ = 1.0f;
    }
    left_ = over > 0.0f ? std::max(0.0f, left_ - dt / over) : 0.0f;
    last_ = {wanted.force + left_ * lacking_.force, wanted.torque + left_ * lacking_.torque};
    if (!last_.is_finite()) {
        lacking_ = {};
        const Wrench bad = last_;
        last_ = {};
        return bad;
    }
    return last_;
}

}  // namespace eti::devices
