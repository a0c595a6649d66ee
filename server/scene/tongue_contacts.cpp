// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/mesh/closest_point.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/scene/friction.hpp"

namespace eti::scene {

namespace {

// [m], beyond a capsule's reach: a previous contact farther away has ended.
constexpr float left_behind = 4e-3f;
// Fraction of an edge's length; nearer to an end, that end has its own contact.
constexpr float min_along = 0.1f;

// Fraction of the shell's force kept per step. It makes the shell compliant, like a wall some thirty times as
// stiff as its contacts. Tissue pressed on a wall by the blade cannot satisfy both; if neither yielded, their
// forces would grow without bound.
constexpr float shell_memory = 0.97f;

// A point forgets half of its displacement from where it stuck per step. Pulled back by all of it, a fine
// tongue between blade and jaw oscillates with the hand on the blade, and under a still blade points
// alternate between sticking and sliding. If all of it were forgotten, every load would make the point creep.
constexpr float stick_memory = 0.5f;

/// Thirty-two bits for the first particle, twenty-four for the second, eight for the obstacle.
std::uint64_t key_of(const pbd::MeshContact& contact, std::uint8_t obstacle) {
    return static_cast<std::uint64_t>(contact.particle[0]) << 32 |
           static_cast<std::uint64_t>(contact.particle[1]) << 8 | obstacle;
}

}  // namespace

void TongueContacts::configure(std::vector<std::uint32_t> movers, std::vector<Edge> edges) {
    movers_ = std::move(movers);
    edges_ = std::move(edges);
    last_.reserve(expected_count());
    now_.reserve(expected_count());
    obstacle_.reserve(expected_count());
    reset();
}

void TongueContacts::reset() {
    last_.clear();
    now_.clear();
    obstacle_.clear();
}

void TongueContacts::find(const pbd::Particles& particles, const MovingBlade& blade, const Shell& shell,
                          std::vector<pbd::MeshContact>& contacts) {
    last_.clear();
    for (std::size_t n = 0; n < contacts.size(); ++n) {
        if (!contacts[n].force.isZero(0.0f)) {
            last_.push_back({key_of(contacts[n], obstacle_[n]), contacts[n].force, contacts[n].slip});
        }
    }
    std::ranges::sort(last_, {}, &PreviousContact::key);
    now_.clear();
    obstacle_.clear();
    collide_blade(particles, blade);
    collide_shell(particles, shell);
    std::swap(now_, contacts);
}

const TongueContacts::PreviousContact* TongueContacts::find_previous(const pbd::MeshContact& contact,
                                                                     std::uint8_t obstacle) const {
    const std::uint64_t key = key_of(contact, obstacle);
    const auto found = std::ranges::lower_bound(last_, key, {}, &PreviousContact::key);
    return found != last_.end() && found->key == key ? &*found : nullptr;
}

void TongueContacts::add(const pbd::MeshContact& contact, std::uint8_t obstacle) {
    const PreviousContact* const last = find_previous(contact, obstacle);
    if (contact.gap >= 0.0f && last == nullptr) {
        return;
    }
    now_.push_back(contact);
    obstacle_.push_back(obstacle);
    if (last != nullptr) {
        now_.back().force = (obstacle == shell_obstacle ? shell_memory : 1.0f) * last->force;
        now_.back().slip += stick_memory * last->slip;
    }
}

void TongueContacts::collide_blade(const pbd::Particles& particles, const MovingBlade& blade) {
    const RigidTransform carry = blade.to * blade.from.inverse();
    const auto slip_of = [&](const Vec3f& before, const Vec3f& now) -> Vec3f { return now - carry * before; };
    float widest = 0.0f;
    for (const std::uint32_t i : movers_) {
        widest = std::max(widest, particles.radius[i]);
    }
    for (std::uint8_t c = 0; c < blade.scope.capsules.size(); ++c) {
        const Capsule& capsule = blade.scope.capsules[c];
        const Vec3f a = blade.to * capsule.a;
        const Vec3f b = blade.to * capsule.b;
        Eigen::AlignedBox3f box(a.cwiseMin(b), a.cwiseMax(b));
        const Vec3f margin = Vec3f::Constant(capsule.radius + widest + left_behind);
        box.min() -= margin;
        box.max() += margin;
        for (const std::uint32_t i : movers_) {
            const Vec3f& x = particles.predicted[i];
            if (!box.contains(x)) {
                continue;
            }
            const Vec3f away = offset_from_segment(a, b, x);
            const float reach = capsule.radius + particles.radius[i];
            const float squared = away.squaredNorm();
            if (squared >= (reach + left_behind) * (reach + left_behind)) {
                continue;
            }
            const float distance = std::sqrt(squared);
            pbd::MeshContact contact;
            contact.particle = {i, i};
            contact.normal = away / std::max(distance, 1e-9f);
            contact.gap = distance - reach;
            contact.slip = slip_of(particles.position[i], x);
            contact.friction = mucosa_on_steel;
            add(contact, c);
        }
        for (const auto& [i, k] : edges_) {
            const Vec3f& x = particles.predicted[i];
            const Vec3f& y = particles.predicted[k];
            // Both ends count: a blade drawn back and pushed forward stretches edges to a centimetre.
            if (!box.intersects(Eigen::AlignedBox3f(x.cwiseMin(y), x.cwiseMax(y)))) {
                continue;
            }
            const auto [t, on_axis] = closest_on_segments(x, y, a, b);
            if (t < min_along || t > 1.0f - min_along) {
                continue;
            }
            const Vec3f point = x + t * (y - x);
            const Vec3f away = point - a - on_axis * (b - a);
            const float distance = away.norm();
            const float reach = capsule.radius + 0.5f * (particles.radius[i] + particles.radius[k]);
            if (distance >= reach + left_behind) {
                continue;
            }
            pbd::MeshContact contact;
            contact.particle = {i, k};
            contact.along = t;
            contact.normal = away / std::max(distance, 1e-9f);
            contact.gap = distance - reach;
            contact.slip = slip_of((1.0f - t) * particles.position[i] + t * particles.position[k], point);
            contact.friction = mucosa_on_steel;
            add(contact, c);
        }
    }
}

void TongueContacts::collide_shell(const pbd::Particles& particles, const Shell& shell) {
    clearance_.begin(movers_.size(), shell.revision);
    auto last = last_.begin();  // both lists are sorted by particle index
    for (std::size_t n = 0; n < movers_.size(); ++n) {
        const std::uint32_t i = movers_[n];
        if ((particles.channels[i] & pbd::channel::shell) == 0) {
            continue;
        }
        const Vec3f& x = particles.predicted[i];
        pbd::MeshContact contact;
        contact.particle = {i, i};
        const std::uint64_t key = key_of(contact, shell_obstacle);
        last = std::find_if(last, last_.end(), [&](const PreviousContact& k) { return k.key >= key; });
        const bool touched = last != last_.end() && last->key == key;
        if (!clearance_.inside(n, x, shell.distance) && !touched) {
            continue;
        }
        const DistanceSample wall = shell.distance.sample(x);
        contact.gap = wall.distance;
        contact.normal = wall.normal;
        contact.slip = x - particles.position[i];
        contact.friction = mucosa_on_mucosa;
        add(contact, shell_obstacle);
    }
}

}  // namespace eti::scene
