// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/blade.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/mesh/closest_point.hpp"

namespace eti::scene {

namespace {

constexpr float tissue_reach = 6e-3f;  // [m], a particle's radius and its way within a step
// [m], an edge's radius and its way within a step; where it moves faster, its ends still meet the blade.
constexpr float edge_reach = 3e-3f;
// In radii of the ends: the blade sinks in between the ends of a shorter edge by less than 0.4 mm.
constexpr float covered = 3.5f;
constexpr std::uint32_t none = ~0u;

}  // namespace

BladeContact::BladeContact(const Laryngoscope& scope, std::vector<Edge> edges)
    : scope_(scope), edges_(std::move(edges)) {}

void BladeContact::begin_step(const pbd::Particles& particles, const RigidTransform& from,
                              const RigidTransform& to) {
    from_ = from;
    to_ = to;
    torque_impulse_.setZero();
    // Where each capsule ends up, and its radius and way, within which it meets what does not move.
    struct Reach {
        Vec3f a, b;
        float distance;
    };
    std::array<Reach, 3> reaches;
    Eigen::AlignedBox3f box;
    for (std::size_t k = 0; k < reaches.size(); ++k) {
        const Capsule& c = scope_.capsules[k];
        const Vec3f a = to * c.a;
        const Vec3f b = to * c.b;
        const float way = std::max((from * c.a - a).norm(), (from * c.b - b).norm());
        reaches[k] = {a, b, c.radius + way};
        const Vec3f margin = Vec3f::Constant(reaches[k].distance + tissue_reach);
        for (const Vec3f& end : {a, b}) {
            box.extend(Vec3f(end - margin));
            box.extend(Vec3f(end + margin));
        }
    }
    for (const std::uint32_t i : reachable_) {
        number_of_[i] = none;
    }
    number_of_.resize(particles.size(), none);
    reachable_.clear();
    particle_meetings_.clear();
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
        const Vec3f& p = particles.position[i];
        if ((particles.channels[i] & pbd::channel::blade) == 0 || particles.inverse_mass[i] == 0.0f ||
            !box.contains(p)) {
            continue;
        }
        for (std::uint32_t c = 0; c < reaches.size(); ++c) {
            const Reach& r = reaches[c];
            if (pbd::away_from(r.a, r.b, p).norm() < r.distance + tissue_reach) {
                if (number_of_[i] == none) {
                    number_of_[i] = static_cast<std::uint32_t>(reachable_.size());
                    reachable_.push_back(i);
                }
                particle_meetings_.push_back({i, i, c});
            }
        }
    }
    edge_meetings_.clear();
    for (const auto& [i, k] : edges_) {
        if (number_of_[i] == none || number_of_[k] == none) {
            continue;
        }
        const Vec3f& a = particles.position[i];
        const Vec3f& b = particles.position[k];
        const float longest = covered * std::min(particles.radius[i], particles.radius[k]);
        if ((b - a).squaredNorm() < longest * longest) {
            continue;
        }
        for (std::uint32_t c = 0; c < reaches.size(); ++c) {
            const Reach& r = reaches[c];
            const auto [s, t] = closest_on_segments(a, b, r.a, r.b);
            if ((a + s * (b - a) - r.a - t * (r.b - r.a)).norm() < r.distance + edge_reach) {
                edge_meetings_.push_back({i, k, c});
            }
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
    push_.assign(reachable_.size(), Vec3f::Zero());
    for (const auto& [i, k, c] : edge_meetings_) {
        const pbd::MovingCapsule& capsule = capsules[c];
        const float t =
            closest_on_segments(particles.predicted[i], particles.predicted[k], capsule.a, capsule.b)[0];
        const auto along = [&, first = i, second = k](const std::vector<Vec3f>& of) {
            return Vec3f((1 - t) * of[first] + t * of[second]);
        };
        const float radius = 0.5f * (particles.radius[i] + particles.radius[k]);
        const Vec3f push = pbd::push_out_of(capsule, along(particles.position), along(particles.predicted),
                                            radius, friction);
        if (push.isZero(0.0f)) {
            continue;
        }
        const float wi = (1 - t) * particles.inverse_mass[i];
        const float wk = t * particles.inverse_mass[k];
        const Vec3f scaled = push / ((1 - t) * wi + t * wk);
        move(particles, i, wi * scaled);
        move(particles, k, wk * scaled);
    }
    for (const auto& [i, unused, c] : particle_meetings_) {
        move(particles, i,
             pbd::push_out_of(capsules[c], particles.position[i], particles.predicted[i], particles.radius[i],
                              friction));
    }
    for (std::size_t n = 0; n < reachable_.size(); ++n) {
        if (!push_[n].isZero(0.0f)) {  // exactly: by default Eigen takes 1e-5 for zero
            const std::uint32_t i = reachable_[n];
            const Vec3f impulse = push_[n] / (particles.inverse_mass[i] * dt);
            impulse_[n] += impulse;
            torque_impulse_ += (particles.predicted[i] - after.translation).cross(impulse);
        }
    }
}

void BladeContact::move(pbd::Particles& particles, std::uint32_t particle, const Vec3f& push) {
    particles.predicted[particle] += push;
    push_[number_of_[particle]] += push;
}

void BladeContact::end_step(const pbd::Particles& particles, float step_dt, Snapshot& snapshot) const {
    snapshot.tissue_contacts.clear();
    Vec3f sum = Vec3f::Zero();
    for (std::size_t n = 0; n < reachable_.size(); ++n) {
        if (impulse_[n].isZero(0.0f)) {
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
