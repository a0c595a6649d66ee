// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tube.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/scene/friction.hpp"

namespace eti::scene {

namespace {

// [m], maximum approach of tissue and tube within a step, besides the tube's own travel.
constexpr float slack = 2e-3f;
// [m], a particle's radius, and more.
constexpr float tube_wake_margin = 3e-3f;
// A lubricated tube on wet mucosa and wet steel: a rigid sled on the wall of the small bowel slides at 0.007
// to 0.054 (Lyle et al., Tribology Letters 2013;51:377). Static friction of a wet tube depends on resting
// time, without a typical value; hence one coefficient for both. [N/m]; at the newton that a hand puts on a
// tube the overlap is a third of a millimetre.
constexpr float stiffness = 3000.0f;
// Contact sites with shell and blade, as fractions of a segment from its rear: 3 mm apart, less than the
// tube's thickness. The last is the tip, so that the whole centre line stays out of the shell.
constexpr float samples[] = {0.25f, 0.5f, 0.75f, 1.0f};
// Half thickness of the blade's plate in contact with the tube: thicker than steel, against tunnelling.
constexpr float plate_half_thickness = 1.5e-3f;  // [m]
// Expected number of particles near a tube in the throat, so that a step does not allocate; not a limit.
constexpr std::size_t max_near_particles = 2048;
// [m], rounding margin of the test that a particle is clear of the tube.
constexpr float tube_rounding = 1e-5f;
constexpr std::size_t near_at_a_time = 256;
// The first pass finds the active contacts, the second their forces.
constexpr int passes = 2;

pbd::RodContact new_contact() {
    pbd::RodContact contact;
    contact.stiffness = stiffness;
    contact.friction = mucosa_on_tube;
    return contact;
}

// [m]; the smooth distances used for the wall's force differ from interpolated ones by less.
constexpr float steady_margin = 0.2e-3f;
// Fraction of the radius beyond which a wall does not stiffen, which leaves a tenth of a millimetre for the
// centre line.
constexpr float hardest = 0.95f;
// [m], maximum displacement of a segment per pass: without a wall near, and at a wall.
constexpr float max_room = 5e-3f;
constexpr float min_room = 0.03e-3f;
// A grid distance changes by at most sqrt(3) times the displacement.
constexpr float room_per_distance = 0.5f;

void limit_clearance(float distance, float& clearance) {
    clearance = std::min(clearance, std::max(room_per_distance * distance, min_room));
}

/// The wall's force at the centre of a tube of `radius` [m]. It derives from an energy, so that a tube moving
/// in cycles between walls gains none, and its direction is continuous. It stiffens as the centre line
/// approaches the wall: stiffness x / (1 - (x / radius)^2) at an overlap of x.
void press(const SplineDistance& wall, float radius, pbd::RodContact& c) {
    const float slope = wall.gradient.norm();
    c.gap = wall.distance - radius;
    c.stiffness = stiffness;
    c.geometric_stiffness.setZero();
    // Midway between walls the gradient vanishes; any direction will do.
    c.normal = slope > 1e-6f ? Vec3f(wall.gradient / slope) : Vec3f(Vec3f::UnitZ());
    if (c.gap >= 0.0f) {
        return;
    }
    const float share = std::min(-c.gap / radius, hardest);
    const float left = 1.0f - share * share;
    const float force = stiffness * (share * radius / left + (-c.gap - share * radius));
    const float harder = stiffness * (1.0f + share * share) / (left * left);
    // The contact law is linear: it gets the tangent.
    c.stiffness = std::max(harder * slope * slope, 1e-3f * stiffness);
    c.gap = -force * slope / c.stiffness;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes(-force * wall.bend);
    c.geometric_stiffness = axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0f).asDiagonal() *
                            axes.eigenvectors().transpose();
}

Vec3f across(const Vec3f& displacement, const Vec3f& normal) {
    return displacement - displacement.dot(normal) * normal;
}

}  // namespace

TubeContact::TubeContact(const Tube& tube, const Laryngoscope& scope, const RigidTransform& grip)
    : scope_(scope), rod_(tube, pbd::RodSettings{.hold = pbd::RodHold{}}, grip), clearance_(rod_.size()) {
    static_assert(std::size(samples) == samples_per_segment);
    near_.reserve(max_near_particles);
    last_near_.reserve(max_near_particles);
    last_force_.reserve(max_near_particles);
    contacts_.reserve(2 * sites() + max_near_particles);
    contacts_.resize(2 * sites(), new_contact());
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        pbd::RodContact& c = contacts_[k];
        c.segment = static_cast<std::uint32_t>(k % sites() / samples_per_segment);
        c.along = samples[k % samples_per_segment];
    }
    reset(grip);
}

void TubeContact::reset(const RigidTransform& grip) {
    rod_.reset(grip);
    grip_from_ = grip_to_ = grip;
    last_ends_.clear();
    near_.clear();
    contacts_.resize(2 * sites());
    for (pbd::RodContact& c : contacts_) {
        c.force.setZero();
    }
}

void TubeContact::nodes(std::vector<Vec3f>& out) const {
    out.resize(rod_.size() + 1);
    rod_.nodes(out);
}

float TubeContact::find_reach(const RigidTransform& grip_from, const RigidTransform& grip_to) {
    // The tube's displacement in the last step plus the grip's in this one: hands do not jump.
    float way = (grip_to.translation - grip_from.translation).norm();
    find_ends();
    for (std::size_t s = 0; s < last_ends_.size(); ++s) {
        way = std::max(way, (ends_[s].front - last_ends_[s].front).norm());
    }
    return slack + 1.5f * way;
}

void TubeContact::wake(pbd::SoftBody& body, const RigidTransform& grip_from, const RigidTransform& grip_to) {
    const float reach = rod_.radius() + find_reach(grip_from, grip_to);
    Eigen::AlignedBox3f box;
    for (const Ends& e : ends_) {
        box.extend(e.rear);
        box.extend(e.front);
    }
    const Vec3f margin = Vec3f::Constant(reach + tube_wake_margin);
    box.min() -= margin;
    box.max() += margin;
    body.sleep.wake_near(body.particles, box, [&](const Vec3f& p, float radius) {
        return std::ranges::any_of(ends_, [&](const Ends& e) {
            return offset_from_segment(e.rear, e.front, p).squaredNorm() <
                   (reach + radius) * (reach + radius);
        });
    });
}

void TubeContact::begin_step(const pbd::Particles& particles, const RigidTransform& grip_from,
                             const RigidTransform& grip_to, const RigidTransform& blade_from,
                             const RigidTransform& blade_to) {
    grip_sum_ = {};
    grip_count_ = 0;
    grip_from_ = grip_from;
    grip_to_ = grip_to;
    blade_from_ = blade_from;
    blade_to_ = blade_to;
    const float reach = find_reach(grip_from, grip_to);
    last_ends_ = ends_;
    Eigen::AlignedBox3f box;
    near_blade_ = false;
    for (const Ends& e : ends_) {
        const Vec3f& p = e.front;
        box.extend(p);
        const Vec3f local = blade_to.inverse() * p;
        near_blade_ = near_blade_ || (std::fabs(local.x()) < 0.02f && std::fabs(local.y()) < 0.02f &&
                                      local.z() > -0.02f && local.z() < scope_.blade_length + 0.02f);
    }
    const Vec3f margin = Vec3f::Constant(rod_.radius() + reach);
    box.min() -= margin;
    box.max() += margin;
    std::swap(near_, last_near_);
    near_.clear();
    const auto pick = [&](std::uint32_t i) {
        if ((particles.channels[i] & pbd::channel::tube) == 0 || particles.inverse_mass[i] == 0.0f ||
            !box.contains(particles.position[i])) {
            return;
        }
        const float far = rod_.radius() + particles.radius[i] + reach;
        Near near{i, static_cast<std::uint32_t>(rod_.size()), 0, particles.position[i]};
        float closest = far * far;
        for (std::size_t s = 0; s < rod_.size(); ++s) {
            const auto& [a, b] = ends_[s];
            const float squared = offset_from_segment(a, b, particles.position[i]).squaredNorm();
            if (squared < far * far) {
                near.first = std::min(near.first, static_cast<std::uint32_t>(s));
                near.end = static_cast<std::uint32_t>(s + 1);
                closest = std::min(closest, squared);
            }
        }
        if (near.first < near.end) {
            near.clear = std::sqrt(closest) - rod_.radius() - particles.radius[i];
            near_.push_back(near);
        }
    };
    particles.for_awake(pick);
    warm_start();
}

void TubeContact::warm_start() {
    // Both lists are sorted by particle index.
    const std::span<const pbd::RodContact> last = std::span(contacts_).subspan(2 * sites());
    last_force_.resize(near_.size());
    std::size_t k = 0;
    for (std::size_t n = 0; n < near_.size(); ++n) {
        while (k < last_near_.size() && last_near_[k].particle < near_[n].particle) {
            ++k;
        }
        const bool goes_on = k < last_near_.size() && last_near_[k].particle == near_[n].particle;
        last_force_[n] = goes_on ? last[k].force : Vec3f(Vec3f::Zero());
    }
    contacts_.resize(2 * sites() + near_.size(), new_contact());
    for (std::size_t n = 0; n < near_.size(); ++n) {
        contacts_[2 * sites() + n].force = last_force_[n];
    }
}

void TubeContact::finish() {
    const pbd::GripWrench now = rod_.grip_wrench();
    grip_sum_.force += now.force;
    grip_sum_.torque += now.torque;
    ++grip_count_;
    rod_.finish();
}

pbd::GripWrench TubeContact::grip_wrench() const {
    const float share = grip_count_ > 0 ? 1.0f / static_cast<float>(grip_count_) : 0.0f;
    return {share * grip_sum_.force, share * grip_sum_.torque};
}

void TubeContact::find_ends() {
    ends_.resize(rod_.size());
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        ends_[s] = {rod_.point(s, 0.0f), rod_.point(s, 1.0f)};
    }
}

void TubeContact::update_segment_travel() {
    travel_.resize(rod_.size());
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        const Ends now{rod_.point(s, 0.0f), rod_.point(s, 1.0f)};
        const auto way_from = [&](const Vec3f& rear, const Vec3f& front) {
            return std::sqrt(std::max((now.rear - rear).squaredNorm(), (now.front - front).squaredNorm()));
        };
        travel_[s] = {way_from(ends_[s].rear, ends_[s].front),
                      way_from(rod_.previous_point(s, 0.0f), rod_.previous_point(s, 1.0f))};
        ends_[s] = now;
    }
}

float TubeContact::max_travel() const {
    float squared = 0.0f;
    for (std::size_t s = 0; s < rod_.size(); ++s) {
        squared = std::max({squared, (rod_.point(s, 0.0f) - ends_[s].rear).squaredNorm(),
                            (rod_.point(s, 1.0f) - ends_[s].front).squaredNorm()});
    }
    return std::sqrt(squared);
}

void TubeContact::predict(float dt, float end, const Vec3f& gravity) {
    dt_ = dt;
    rod_.predict(dt, gravity, interpolate(grip_from_, grip_to_, end));
}

void TubeContact::project(pbd::Particles& particles, const Walls& walls, float begin, float end) {
    find_clearance(walls);
    rod_.limit_motion(clearance_);
    for (int pass = 0; pass < passes; ++pass) {
        collide_shell(walls);
        collide_blade(interpolate(blade_from_, blade_to_, begin), interpolate(blade_from_, blade_to_, end));
        collide_tissue(particles);
        rod_.solve(contacts_, clearance_);
        if (near_.empty()) {
            const float way = max_travel();
            if (std::ranges::all_of(contacts_, [&](const auto& c) { return c.gap > way; })) {
                break;  // without contact there is nothing to distribute
            }
        }
    }
    for (std::size_t n = 0; n < near_.size(); ++n) {
        const std::uint32_t i = near_[n].particle;
        const pbd::RodContact& c = contacts_[2 * sites() + n];
        particles.predicted[i] -= c.compliance * c.force;
    }
}

void TubeContact::find_clearance(const Walls& walls) {
    std::ranges::fill(clearance_, max_room);
    for (std::size_t k = 0; k < sites(); ++k) {
        const pbd::RodContact& c = contacts_[k];
        limit_clearance(walls.distance(rod_.previous_point(c.segment, c.along)), clearance_[c.segment]);
    }
}

void TubeContact::collide_shell(const Walls& walls) {
    std::ranges::fill(clearance_, max_room);
    for (std::size_t k = 0; k < sites(); ++k) {
        pbd::RodContact& c = contacts_[k];
        const Vec3f p = rod_.point(c.segment, c.along);
        const float distance = walls.distance(p);
        limit_clearance(distance, clearance_[c.segment]);
        c.gap = distance - rod_.radius();
        if (c.gap >= steady_margin && c.force.isZero(0.0f)) {
            continue;  // inactive
        }
        press(walls.spline_sample(p), rod_.radius(), c);
        c.offset = -rod_.radius() * c.normal;
        c.slip = across(p - rod_.previous_point(c.segment, c.along), c.normal);
    }
}

void TubeContact::collide_blade(const RigidTransform& before, const RigidTransform& now) {
    const RigidTransform into = now.inverse();
    const float crest_base = scope_.capsules[1].radius;
    const float crest_tip = scope_.capsules[2].radius;
    for (std::size_t k = sites(); k < 2 * sites(); ++k) {
        pbd::RodContact& c = contacts_[k];
        if (!near_blade_) {
            c.gap = 1.0f;
            c.force.setZero();
            continue;
        }
        const Vec3f world = rod_.point(c.segment, c.along);
        const Vec3f p = into * world;
        const float u = std::clamp(p.z() / scope_.blade_length, 0.0f, 1.0f);
        const Vec3f half(crest_base + (crest_tip - crest_base) * u, plate_half_thickness,
                         0.5f * scope_.blade_length);
        const Vec3f centre(0.0f, half.x() - plate_half_thickness, 0.5f * scope_.blade_length);
        // Distance to a box: outside by the clamped offset, inside by the distance through the plate.
        const Vec3f offset = p - centre;
        const Vec3f beyond = offset.cwiseAbs() - half;
        const Vec3f outside = beyond.cwiseMax(0.0f);
        const float distance = outside.norm();
        Vec3f normal;
        if (distance > 1e-7f) {
            normal = outside.cwiseProduct(offset.cwiseSign()) / distance;
            c.gap = distance - rod_.radius();
        } else {
            normal = Vec3f(0.0f, offset.y() < 0.0f ? -1.0f : 1.0f, 0.0f);
            c.gap = beyond.y() - rod_.radius();
        }
        c.normal = now.rotation * normal;
        c.offset = -rod_.radius() * c.normal;
        const Vec3f carried = world - before * p;  // motion of that point of the blade
        c.slip = across(world - rod_.previous_point(c.segment, c.along) - carried, c.normal);
    }
}

void TubeContact::collide_tissue(const pbd::Particles& particles) {
    update_segment_travel();
    parallel::for_each(near_.size(), near_at_a_time,
                       [&](std::size_t n) { meet(particles, near_[n], contacts_[2 * sites() + n]); });
}

void TubeContact::meet(const pbd::Particles& particles, Near& near, pbd::RodContact& c) const {
    const std::uint32_t i = near.particle;
    const Vec3f& p = particles.predicted[i];
    const Vec3f& before = particles.position[i];
    const float radius = particles.radius[i];
    SegmentTravel way;
    for (std::uint32_t s = near.first; s < near.end; ++s) {
        way.since_found = std::max(way.since_found, travel_[s].since_found);
        way.of_substep = std::max(way.of_substep, travel_[s].of_substep);
    }
    near.clear -= way.since_found;
    if (c.force.isZero(0.0f)) {
        const float clear = near.clear - (p - near.at).norm();
        if (clear > way.of_substep + (p - before).norm() + tube_rounding) {
            c.gap = clear;
            return;  // no contact on its whole path
        }
    }
    constexpr float none = 1.0f;
    float closest = none;
    for (std::uint32_t s = near.first; s < near.end; ++s) {
        const auto& [a, b] = ends_[s];
        const float t = closest_on_segment(a, b, p);
        const Vec3f from = a + t * (b - a) - p;
        const float distance = from.norm();
        if (distance < closest && distance > 1e-7f) {
            closest = distance;
            c.segment = s;
            c.along = t;
            c.normal = from / distance;
        }
    }
    c.gap = closest - rod_.radius() - radius;
    c.offset = -rod_.radius() * c.normal;
    near.at = p;
    near.clear = closest < none ? c.gap : 0.0f;
    stop_head_on(before, p, radius, c);
    c.compliance = particles.inverse_mass[i] * dt_ * dt_;
    c.slip = across(rod_.point(c.segment, c.along) - rod_.previous_point(c.segment, c.along) - (p - before),
                    c.normal);
}

void TubeContact::stop_head_on(const Vec3f& before, const Vec3f& now, float radius,
                               pbd::RodContact& c) const {
    const float reach = rod_.radius() + radius;
    const Vec3f moved = rod_.point(c.segment, c.along) - rod_.previous_point(c.segment, c.along);
    if (!pbd::runs_head_on(moved, moved.normalized(), reach)) {
        return;  // too slow
    }
    const Vec3f from = before + moved;  // in the frame of the tube's current position
    const auto& [a, b] = ends_[c.segment];
    const std::optional<Vec3f> met = pbd::first_contact(a, b, reach, from, now);
    if (!met.has_value()) {
        return;
    }
    const Vec3f normal = offset_from_segment(a, b, *met).normalized();
    const Vec3f displacement = now - from;
    if (displacement.dot(normal) < 0.0f && pbd::runs_head_on(moved, normal, reach)) {
        // If the tube has passed over it, the particle is moved back to the point of impact.
        const Vec3f clear =
            c.gap < 0.0f ? pbd::pushed_clear(a, b, reach, now, moved.normalized()) : Vec3f(*met);
        const Vec3f push = clear - now;
        c.gap = -push.norm();
        c.normal = -push.normalized();
        c.offset = rod_.radius() * normal;
    }
}

}  // namespace eti::scene
