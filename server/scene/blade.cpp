// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/blade.hpp"

#include <algorithm>

namespace eti::scene {

void BladeContact::begin_step(const pbd::Particles& particles, const RigidTransform& from,
                              const RigidTransform& to) {
    from_ = from;
    to_ = to;
    torque_impulse_.setZero();
    Eigen::AlignedBox3f box;
    float reach = 0.0f;
    for (const Capsule& capsule : scope_.capsules) {
        for (const RigidTransform& pose : {from, to}) {
            box.extend(pose * capsule.a);
            box.extend(pose * capsule.b);
        }
        reach = std::max(reach, capsule.radius);
    }
    // Tissue moves less than this within a step.
    const Vec3f margin = Vec3f::Constant(reach + 6e-3f);
    box.min() -= margin;
    box.max() += margin;
    reachable_.clear();
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
        if ((particles.channels[i] & pbd::channel::blade) != 0 && particles.inverse_mass[i] > 0.0f &&
            box.contains(particles.position[i])) {
            reachable_.push_back(i);
        }
    }
    impulse_.assign(reachable_.size(), Vec3f::Zero());
}

RigidTransform BladeContact::pose_at(float share) const {
    return {from_.rotation.slerp(share, to_.rotation),
            from_.translation + share * (to_.translation - from_.translation)};
}

void BladeContact::project(pbd::Particles& particles, float begin, float end, float dt) {
    const RigidTransform before = pose_at(begin);
    const RigidTransform after = pose_at(end);
    std::array<pbd::MovingCapsule, 3> capsules;
    for (std::size_t k = 0; k < capsules.size(); ++k) {
        const Capsule& c = scope_.capsules[k];
        capsules[k] = {before * c.a, before * c.b, after * c.a, after * c.b, c.radius};
    }
    for (std::size_t n = 0; n < reachable_.size(); ++n) {
        const std::uint32_t i = reachable_[n];
        Vec3f total = Vec3f::Zero();
        for (const pbd::MovingCapsule& capsule : capsules) {
            const Vec3f push = pbd::push_out_of(capsule, particles.position[i], particles.predicted[i],
                                                particles.radius[i], friction);
            particles.predicted[i] += push;
            total += push;
        }
        if (!total.isZero()) {
            const Vec3f impulse = total / (particles.inverse_mass[i] * dt);
            impulse_[n] += impulse;
            torque_impulse_ += (particles.predicted[i] - after.translation).cross(impulse);
        }
    }
}

void BladeContact::end_step(const pbd::Particles& particles, float step_dt, Snapshot& snapshot) const {
    snapshot.tissue_contacts.clear();
    Vec3f sum = Vec3f::Zero();
    for (std::size_t n = 0; n < reachable_.size(); ++n) {
        if (impulse_[n].isZero()) {
            continue;
        }
        const std::uint32_t i = reachable_[n];
        sum += impulse_[n];
        snapshot.tissue_contacts.push_back({particles.position[i], particles.rest[i], -impulse_[n] / step_dt,
                                            particles.radius[i], static_cast<Tissue>(particles.object[i])});
    }
    snapshot.tissue_force = -sum / step_dt;
    snapshot.tissue_torque = -torque_impulse_ / step_dt;
}

}  // namespace eti::scene
