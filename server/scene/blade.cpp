// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/blade.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/mesh/closest_point.hpp"

namespace eti::scene {

namespace {

constexpr float tissue_reach = 6e-3f;  // [m], a particle's radius and its displacement within a step
// [m], an edge's radius and its displacement within a step; if it is faster, its ends still collide.
constexpr float edge_reach = 3e-3f;
// In radii of the ends: between the ends of a shorter edge the blade sinks in by less than 0.4 mm.
constexpr float covered = 3.5f;
// [m], half of an edge between particles pressed apart, whose middle the blade may touch.
constexpr float blade_wake_margin = 3e-3f;
// Multiple of this step's travel within which tissue is woken: margin for a blade that accelerates.
constexpr float wake_ahead = 2.0f;
constexpr std::uint32_t none = ~0u;
// [m], bound of rounding errors of distances between points a few decimetres from the origin.
constexpr float blade_rounding = 1e-6f;

}  // namespace

BladeContact::BladeContact(const Laryngoscope& scope, std::vector<Edge> edges, std::vector<bool> excluded)
    : scope_(scope), edges_(std::move(edges)), excluded_(std::move(excluded)) {
    if (!excluded_.empty()) {
        std::erase_if(edges_, [&](const Edge& e) { return excluded_[e[0]] && excluded_[e[1]]; });
    }
    std::ranges::sort(edges_);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        first_edge_.resize(edges_[e][0] + std::size_t{1}, static_cast<std::uint32_t>(e));
    }
    first_edge_.push_back(static_cast<std::uint32_t>(edges_.size()));
}

void BladeContact::wake(pbd::SoftBody& body, const RigidTransform& from, const RigidTransform& to) const {
    for (const Capsule& c : scope_.capsules) {
        const Vec3f a = to * c.a;
        const Vec3f b = to * c.b;
        const float way = std::max((from * c.a - a).norm(), (from * c.b - b).norm());
        const float reach = c.radius + wake_ahead * way + blade_wake_margin;
        Eigen::AlignedBox3f box(a.cwiseMin(b), a.cwiseMax(b));
        const Vec3f margin = Vec3f::Constant(reach + tissue_reach);  // a particle's radius, and more
        box.min() -= margin;
        box.max() += margin;
        body.sleep.wake_near(body.particles, box, [&](const Vec3f& p, float radius) {
            return offset_from_segment(a, b, p).squaredNorm() < (reach + radius) * (reach + radius);
        });
    }
}

void BladeContact::reset() {
    std::ranges::fill(impulse_, Vec3f::Zero());
    torque_impulse_.setZero();
}

void BladeContact::begin_step(const pbd::Particles& particles, const RigidTransform& from,
                              const RigidTransform& to) {
    from_ = from;
    to_ = to;
    motion_ = {};
    torque_impulse_.setZero();
    travel_ = 0.0f;
    // Final position of each capsule, with its radius and travel, within which it touches resting particles.
    struct Reach {
        Vec3f a, b;
        float way;
        float distance;
        float least;  // [m], distance beyond it that excludes contact anywhere on the path
        float far;    // [m], distance from the axis that excludes contact
        Vec3f along;
        float inverse_squared;  // [1/m^2], of the axis's length
    };
    // Ends of rotating capsules move on arcs, which deviate from chords by less than this fraction of the
    // arm.
    const float turn = from.rotation.angularDistance(to.rotation);
    const float bow = turn * turn;
    std::array<Reach, 3> reaches;
    Eigen::AlignedBox3f box;
    for (std::size_t k = 0; k < reaches.size(); ++k) {
        const Capsule& c = scope_.capsules[k];
        const Vec3f a = to * c.a;
        const Vec3f b = to * c.b;
        const float way = std::max((from * c.a - a).norm(), (from * c.b - b).norm());
        reaches[k] = {a,
                      b,
                      way,
                      c.radius + way,
                      bow * std::max(c.a.norm(), c.b.norm()),
                      c.radius + way + tissue_reach,
                      b - a,
                      1.0f / std::max((b - a).squaredNorm(), 1e-12f)};
        const Vec3f margin = Vec3f::Constant(reaches[k].distance + tissue_reach);
        for (const Vec3f& end : {a, b}) {
            box.extend(Vec3f(end - margin));
            box.extend(Vec3f(end + margin));
        }
    }
    for (const std::uint32_t i : reachable_) {
        reachable_index_[i] = none;
    }
    if (reachable_index_.size() != particles.size()) {
        reachable_index_.resize(particles.size(), none);
        reachable_.reserve(particles.size());  // a step does not allocate
        impulse_.reserve(particles.size());
    }
    reachable_.clear();
    particle_candidates_.clear();
    const auto pick = [&](std::uint32_t i) {
        const Vec3f& p = particles.position[i];
        if ((particles.channels[i] & pbd::channel::blade) == 0 || particles.inverse_mass[i] == 0.0f ||
            !box.contains(p)) {
            return;
        }
        ParticleCandidate meeting{i, {}, {{p, p}, tissue_reach, 0.0f}};
        bool near = false;
        for (std::uint32_t c = 0; c < reaches.size(); ++c) {
            const Reach& r = reaches[c];
            const Vec3f from_a = p - r.a;
            const float t = std::clamp(from_a.dot(r.along) * r.inverse_squared, 0.0f, 1.0f);
            const float squared = (from_a - t * r.along).squaredNorm();
            if (squared < r.far * r.far) {
                near = meeting.capsule[c] = true;
                travel_ = std::max(travel_, r.way);
                meeting.clearance.gap = std::min(
                    meeting.clearance.gap, std::sqrt(squared) - r.distance - particles.radius[i] - r.least);
            }
        }
        if (near) {
            reachable_index_[i] = static_cast<std::uint32_t>(reachable_.size());
            reachable_.push_back(i);
            if (excluded_.empty() || !excluded_[i]) {
                particle_candidates_.push_back(meeting);
            }
        }
    };
    particles.for_awake(pick);
    edge_candidates_.clear();
    for (const std::uint32_t i : reachable_) {
        if (i + std::size_t{1} >= first_edge_.size()) {
            break;
        }
        for (std::uint32_t e = first_edge_[i]; e < first_edge_[i + 1]; ++e) {
            const std::uint32_t k = edges_[e][1];
            if (reachable_index_[k] == none) {
                continue;
            }
            const Vec3f& a = particles.position[i];
            const Vec3f& b = particles.position[k];
            const float longest = covered * std::min(particles.radius[i], particles.radius[k]);
            if ((b - a).squaredNorm() < longest * longest) {
                continue;
            }
            const float radius = 0.5f * (particles.radius[i] + particles.radius[k]);
            for (std::uint32_t c = 0; c < reaches.size(); ++c) {
                const Reach& r = reaches[c];
                const auto [s, t] = closest_on_segments(a, b, r.a, r.b);
                const float away = (a + s * (b - a) - r.a - t * (r.b - r.a)).norm() - r.distance;
                if (away < edge_reach) {
                    edge_candidates_.push_back({i, k, c, {{a, b}, away - radius - r.least, 0.0f}});
                }
            }
        }
    }
    impulse_.assign(reachable_.size(), Vec3f::Zero());
}

RigidTransform BladeContact::pose_at(float share) const {
    return interpolate(from_, to_, share);
}

void BladeContact::project(pbd::Particles& particles, float begin, float end, float dt) {
    const RigidTransform before = pose_at(begin);
    const RigidTransform after = pose_at(end);
    std::array<pbd::MovingCapsule, 3> capsules;
    for (std::size_t k = 0; k < capsules.size(); ++k) {
        const Capsule& c = scope_.capsules[k];
        capsules[k] = {before * c.a, before * c.b, after * c.a, after * c.b, c.radius};
    }
    motion_.now = 0.0f;
    for (const pbd::MovingCapsule& c : capsules) {
        motion_.now = std::max({motion_.now, (c.a - c.a_before).norm(), (c.b - c.b_before).norm()});
    }
    motion_.in_step += motion_.now;
    push_.assign(reachable_.size(), Vec3f::Zero());
    collide_edges(particles, capsules);
    collide_particles(particles, capsules);
    for (std::size_t n = 0; n < reachable_.size(); ++n) {
        if (!push_[n].isZero(0.0f)) {  // exactly: Eigen's default tolerance is 1e-5
            const std::uint32_t i = reachable_[n];
            const Vec3f impulse = push_[n] / (particles.inverse_mass[i] * dt);
            impulse_[n] += impulse;
            torque_impulse_ += (particles.predicted[i] - after.translation).cross(impulse);
        }
    }
}

/// Whether the particles, including every point of the edge between them, and the blade have moved too little
/// since the cached distance to touch anywhere in this substep.
bool BladeContact::out_of_reach(const pbd::Particles& particles, std::uint32_t first, std::uint32_t second,
                                const Clearance& last, const Motion& blade) {
    if (last.gap <= blade_rounding) {
        return false;
    }
    const auto gone = [&](std::uint32_t i, const Vec3f& seen) {
        const Vec3f& p = particles.predicted[i];
        return (p - seen).norm() + (p - particles.position[i]).norm();
    };
    float way = gone(first, last.seen[0]);
    if (second != first) {
        way = std::max(way, gone(second, last.seen[1]));
    }
    return way + (blade.in_step - last.travelled) + blade.now + blade_rounding < last.gap;
}

void BladeContact::collide_edges(pbd::Particles& particles,
                                 const std::array<pbd::MovingCapsule, 3>& capsules) {
    for (auto& [i, k, c, clearance] : edge_candidates_) {
        if (out_of_reach(particles, i, k, clearance, motion_)) {
            continue;
        }
        const pbd::MovingCapsule& capsule = capsules[c];
        const auto [t, on_axis] =
            closest_on_segments(particles.predicted[i], particles.predicted[k], capsule.a, capsule.b);
        const auto along = [&, t = t, first = i, second = k](const std::vector<Vec3f>& of) {
            return Vec3f((1 - t) * of[first] + t * of[second]);
        };
        const float radius = 0.5f * (particles.radius[i] + particles.radius[k]);
        const Vec3f point = along(particles.predicted);
        clearance = {{particles.predicted[i], particles.predicted[k]},
                     (point - capsule.a - on_axis * (capsule.b - capsule.a)).norm() - capsule.radius - radius,
                     motion_.in_step};
        const Vec3f push = pbd::push_out_of(capsule, along(particles.position), point, radius, friction);
        if (push.isZero(0.0f)) {
            continue;
        }
        const float wi = (1 - t) * particles.inverse_mass[i];
        const float wk = t * particles.inverse_mass[k];
        const Vec3f scaled = push / ((1 - t) * wi + t * wk);
        move(particles, i, wi * scaled);
        move(particles, k, wk * scaled);
    }
}

void BladeContact::collide_particles(pbd::Particles& particles,
                                     const std::array<pbd::MovingCapsule, 3>& capsules) {
    for (auto& [i, meets, clearance] : particle_candidates_) {
        if (out_of_reach(particles, i, i, clearance, motion_)) {
            continue;
        }
        const Vec3f seen = particles.predicted[i];
        const float radius = particles.radius[i];
        const float way = (seen - particles.position[i]).norm() + motion_.now + blade_rounding;
        float gap = 1.0f;
        bool moved = false;
        for (std::size_t c = 0; c < capsules.size(); ++c) {
            if (!meets[c]) {
                continue;
            }
            const pbd::MovingCapsule& capsule = capsules[c];
            const float away =
                offset_from_segment(capsule.a, capsule.b, seen).norm() - capsule.radius - radius;
            gap = std::min(gap, away);
            if (moved || away <= way) {
                move(particles, i,
                     pbd::push_out_of(capsule, particles.position[i], particles.predicted[i], radius,
                                      friction));
                moved = true;
            }
        }
        clearance = {{seen, seen}, gap, motion_.in_step};
    }
}

void BladeContact::move(pbd::Particles& particles, std::uint32_t particle, const Vec3f& push) {
    particles.predicted[particle] += push;
    push_[reachable_index_[particle]] += push;
}

void BladeContact::add_impulse(std::uint32_t particle, const Vec3f& position, const Vec3f& impulse,
                               const RigidTransform& pose) {
    if (reachable_index_[particle] == none) {
        reachable_index_[particle] = static_cast<std::uint32_t>(reachable_.size());
        reachable_.push_back(particle);
        impulse_.push_back(Vec3f::Zero());
    }
    impulse_[reachable_index_[particle]] += impulse;
    torque_impulse_ += (position - pose.translation).cross(impulse);
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
