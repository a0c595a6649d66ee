// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue/tongue_contacts.hpp"

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

// Fraction of the shell's force kept per step. It makes the shell compliant, like a wall some thirty times as
// stiff as its contacts. Tissue pressed on a wall by the blade cannot satisfy both; if neither yielded, their
// forces would grow without bound.
constexpr float shell_memory = 0.97f;

// A point forgets half of its displacement from where it stuck per step. Pulled back by all of it, a fine
// tongue between blade and jaw oscillates with the hand on the blade, and under a still blade points
// alternate between sticking and sliding. If all of it were forgotten, every load would make the point creep.
constexpr float stick_memory = 0.5f;

// Where a triangle touches: at its three Gauss points. The corner nearest to one bears two thirds of its
// force.
constexpr std::size_t points_per_triangle = 3;
constexpr float own_corner = 2.0f / 3.0f;
// There are six such points per particle; the stiffness of contacts is that of four.
constexpr float triangle_point_share = 2.0f / 3.0f;

std::uint64_t key_of(std::size_t feature, std::uint8_t obstacle) {
    return static_cast<std::uint64_t>(feature) << 8 | obstacle;
}

}  // namespace

void TongueContacts::configure(std::vector<std::uint32_t> movers, Surface surface) {
    movers_ = std::move(movers);
    surface_ = std::move(surface);
    last_.reserve(expected_count());
    now_.reserve(expected_count());
    key_.reserve(expected_count());
    reset();
}

void TongueContacts::reset() {
    last_.clear();
    now_.clear();
    key_.clear();
}

void TongueContacts::find(const pbd::Particles& particles, const MovingBlade& blade, const Walls& walls,
                          std::vector<pbd::MeshContact>& contacts) {
    last_.clear();
    for (std::size_t n = 0; n < contacts.size(); ++n) {
        if (!contacts[n].force.isZero(0.0f)) {
            last_.push_back({key_[n], contacts[n].force, contacts[n].slip});
        }
    }
    std::ranges::sort(last_, {}, &PreviousContact::key);
    now_.clear();
    key_.clear();
    collide_blade(particles, blade);
    collide_shell(particles, walls);
    std::swap(now_, contacts);
}

const TongueContacts::PreviousContact* TongueContacts::find_previous(std::uint64_t key) const {
    const auto found = std::ranges::lower_bound(last_, key, {}, &PreviousContact::key);
    return found != last_.end() && found->key == key ? &*found : nullptr;
}

void TongueContacts::add(const pbd::MeshContact& contact, std::size_t feature, std::uint8_t obstacle) {
    const std::uint64_t key = key_of(feature, obstacle);
    const PreviousContact* const last = find_previous(key);
    if (contact.gap >= 0.0f && last == nullptr) {
        return;
    }
    now_.push_back(contact);
    key_.push_back(key);
    if (last != nullptr) {
        now_.back().force = (obstacle == shell_obstacle ? shell_memory : 1.0f) * last->force;
        now_.back().slip += stick_memory * last->slip;
    }
}

void TongueContacts::collide_blade(const pbd::Particles& particles, const MovingBlade& blade) {
    const RigidTransform carry = blade.to * blade.from.inverse();
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
        // Adds a contact at a point with these corners, whose ball is `away` from the axis.
        const auto touch = [&](pbd::MeshContact& contact, std::size_t feature, const Vec3f& now,
                               const Vec3f& away) {
            Vec3f before = contact.share[0] * particles.position[contact.particle[0]];
            float radius = particles.radius[contact.particle[0]];
            for (std::size_t k = 1; k < contact.corners; ++k) {
                before += contact.share[k] * particles.position[contact.particle[k]];
                radius += particles.radius[contact.particle[k]];
            }
            const float reach = capsule.radius + radius / static_cast<float>(contact.corners);
            const float distance = away.norm();
            if (distance >= reach + left_behind) {
                return;
            }
            contact.normal = away / std::max(distance, 1e-9f);
            contact.gap = distance - reach;
            contact.slip = now - carry * before;
            contact.friction = mucosa_on_steel;
            add(contact, feature, c);
        };
        std::size_t feature = movers_.size();
        for (const std::uint32_t i : surface_.particles) {
            const Vec3f& x = particles.predicted[i];
            if (box.contains(x)) {
                pbd::MeshContact contact = pbd::MeshContact::at_particle(i);
                touch(contact, feature, x, offset_from_segment(a, b, x));
            }
            ++feature;
        }
        for (const Triangle& triangle : surface_.triangles) {
            const std::array corner = {particles.predicted[triangle[0]], particles.predicted[triangle[1]],
                                       particles.predicted[triangle[2]]};
            Eigen::AlignedBox3f around(corner[0]);
            around.extend(corner[1]).extend(corner[2]);
            for (std::size_t k = 0; k < points_per_triangle && box.intersects(around); ++k) {
                pbd::MeshContact contact;
                contact.corners = 3;
                contact.share.fill(0.5f * (1.0f - own_corner));
                contact.share[k] = own_corner;
                Vec3f point = Vec3f::Zero();
                for (std::size_t l = 0; l < 3; ++l) {
                    contact.particle[l] = triangle[l];
                    point += contact.share[l] * corner[l];
                }
                contact.area_share = triangle_point_share;
                touch(contact, feature + k, point, offset_from_segment(a, b, point));
            }
            feature += points_per_triangle;
        }
    }
}

void TongueContacts::collide_shell(const pbd::Particles& particles, const Walls& walls) {
    clearance_.begin(movers_.size(), walls);
    auto last = last_.begin();  // both lists are sorted by mover
    for (std::size_t n = 0; n < movers_.size(); ++n) {
        const std::uint32_t i = movers_[n];
        if ((particles.channels[i] & pbd::channel::shell) == 0) {
            continue;
        }
        const Vec3f& x = particles.predicted[i];
        pbd::MeshContact contact = pbd::MeshContact::at_particle(i);
        const std::uint64_t key = key_of(n, shell_obstacle);
        last = std::find_if(last, last_.end(), [&](const PreviousContact& k) { return k.key >= key; });
        const bool touched = last != last_.end() && last->key == key;
        if (!clearance_.inside(n, x, walls) && !touched) {
            continue;
        }
        const DistanceSample wall = walls.sample(x);
        contact.gap = wall.distance;
        contact.normal = wall.normal;
        contact.slip = x - particles.position[i];
        contact.friction = mucosa_on_mucosa;
        add(contact, n, shell_obstacle);
    }
}

}  // namespace eti::scene
