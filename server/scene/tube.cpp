// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tube.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/contact.hpp"

namespace eti::scene {

namespace {

const Vec3f gravity(0.0f, 9.81f, 0.0f);  // [m/s^2]; the patient lies on its back: +y is posterior
constexpr float reach = 6e-3f;           // [m]; neither tissue nor tube moves farther within a step
constexpr float shell_friction = 0.05f;  // Coulomb; a lubricated tube on wet mucosa
// The shell and the blade meet the tube in points this share of a segment apart: 2.5 mm for 5 mm
// segments, less than the tube's own radius away from any spot between.
constexpr float samples[] = {0.5f, 1.0f};
// The blade's plate as the tube meets it: thicker than steel, so that it is not stepped through.
constexpr float plate_half_thickness = 1.5e-3f;  // [m]

RigidTransform between(const RigidTransform& a, const RigidTransform& b, float share) {
    return {a.rotation.slerp(share, b.rotation), a.translation + share * (b.translation - a.translation)};
}

}  // namespace

TubeContact::TubeContact(const Tube& tube, const Laryngoscope& scope, const RigidTransform& grip)
    : scope_(scope), rod_(tube, pbd::RodSettings{}, grip) {}

void TubeContact::reset(const RigidTransform& grip) {
    rod_.reset(grip);
    grip_from_ = grip_to_ = grip;
}

void TubeContact::nodes(std::vector<Vec3f>& out) const {
    out.resize(rod_.size() + 1);
    rod_.nodes(out);
}

void TubeContact::begin_step(const pbd::Particles& particles, const RigidTransform& grip_from,
                             const RigidTransform& grip_to, const RigidTransform& blade_from,
                             const RigidTransform& blade_to) {
    grip_from_ = grip_from;
    grip_to_ = grip_to;
    blade_from_ = blade_from;
    blade_to_ = blade_to;
    Eigen::AlignedBox3f box;
    near_blade_ = false;
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        const Vec3f p = rod_.point(s, 1.0f);
        box.extend(p);
        const Vec3f local = blade_to.inverse() * p;
        near_blade_ = near_blade_ || (std::fabs(local.x()) < 0.02f && std::fabs(local.y()) < 0.02f &&
                                      local.z() > -0.02f && local.z() < scope_.blade_length + 0.02f);
    }
    const Vec3f margin = Vec3f::Constant(rod_.radius() + reach);
    box.min() -= margin;
    box.max() += margin;
    reachable_.clear();
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
        if ((particles.channels[i] & pbd::channel::tube) == 0 || particles.inverse_mass[i] == 0.0f ||
            !box.contains(particles.position[i])) {
            continue;
        }
        const float far = rod_.radius() + particles.radius[i] + reach;
        for (std::size_t s = 0; s < rod_.size(); ++s) {
            const Vec3f a = rod_.point(s, 0.0f);
            const Vec3f b = rod_.point(s, 1.0f);
            const float t = pbd::closest_on_segment(a, b, particles.position[i]);
            if ((particles.position[i] - a - t * (b - a)).squaredNorm() < far * far) {
                reachable_.push_back(i);
                break;
            }
        }
    }
}

void TubeContact::predict(float dt, float share) {
    rod_.predict(dt, gravity, between(grip_from_, grip_to_, share));
}

void TubeContact::project(pbd::Particles& particles, const DistanceGrid& shell, float share) {
    meet_shell(shell);
    rod_.solve();
    meet_tissue(particles);
    if (near_blade_) {
        meet_blade(between(blade_from_, blade_to_, share));
    }
    meet_shell(shell);
}

void TubeContact::meet_shell(const DistanceGrid& shell) {
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        for (const float along : samples) {
            const Vec3f push = pbd::push_out_of(shell, rod_.previous_point(s, along), rod_.point(s, along),
                                                rod_.radius(), shell_friction);
            if (!push.isZero()) {
                rod_.displace(s, along, -rod_.radius() * push.normalized(), push);
            }
        }
    }
}

void TubeContact::meet_blade(const RigidTransform& blade) {
    const RigidTransform into = blade.inverse();
    const float crest_base = scope_.capsules[1].radius;
    const float crest_tip = scope_.capsules[2].radius;
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        for (const float along : samples) {
            const Vec3f p = into * rod_.point(s, along);
            const float u = std::clamp(p.z() / scope_.blade_length, 0.0f, 1.0f);
            const Vec3f half(crest_base + (crest_tip - crest_base) * u, plate_half_thickness,
                             0.5f * scope_.blade_length);
            const Vec3f centre(0.0f, half.x() - plate_half_thickness, 0.5f * scope_.blade_length);
            // Distance to a box: outside by the clamped offset, inside by the thinnest way out.
            const Vec3f offset = p - centre;
            const Vec3f beyond = offset.cwiseAbs() - half;
            const Vec3f outside = beyond.cwiseMax(0.0f);
            const float distance = outside.norm();
            if (distance >= rod_.radius()) {
                continue;
            }
            Vec3f normal;
            float depth = rod_.radius() - distance;
            if (distance > 1e-7f) {
                normal = outside.cwiseProduct(offset.cwiseSign()) / distance;
            } else {
                normal = Vec3f(0.0f, offset.y() < 0.0f ? -1.0f : 1.0f, 0.0f);
                depth = rod_.radius() - beyond.y();
            }
            const Vec3f push = blade.rotation * (depth * normal);
            rod_.displace(s, along, -rod_.radius() * push.normalized(), push);
        }
    }
}

void TubeContact::meet_tissue(pbd::Particles& particles) {
    for (const std::uint32_t i : reachable_) {
        const float meet = rod_.radius() + particles.radius[i];
        for (std::size_t s = 0; s < rod_.size(); ++s) {
            const Vec3f a = rod_.point(s, 0.0f);
            const Vec3f b = rod_.point(s, 1.0f);
            const float t = pbd::closest_on_segment(a, b, particles.predicted[i]);
            const Vec3f apart = particles.predicted[i] - a - t * (b - a);
            const float distance = apart.norm();
            if (distance >= meet || distance < 1e-7f) {
                continue;
            }
            const Vec3f normal = apart / distance;
            const Vec3f offset = rod_.radius() * normal;
            const float segment = rod_.inverse_mass(s, t, offset, normal);
            const float impulse = (meet - distance) / (segment + particles.inverse_mass[i]);
            particles.predicted[i] += particles.inverse_mass[i] * impulse * normal;
            rod_.push(s, t, offset, -impulse * normal);
        }
    }
}

}  // namespace eti::scene
