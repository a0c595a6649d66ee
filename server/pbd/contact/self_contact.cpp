// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/self_contact.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/soft/sleep.hpp"

namespace eti::pbd {

namespace {

constexpr float bounds_margin =
    0.03f;  // [m], by which tissue may leave its rest bounding box and still be tested

}  // namespace

void SelfContact::configure(std::vector<std::uint32_t> who, std::span<const std::uint32_t> first,
                            std::span<const std::uint32_t> member, const Particles& particles) {
    surface_particles_ = std::move(who);
    std::vector<std::vector<std::uint32_t>> groups(particles.size());
    for (std::uint32_t g = 0; g + 1 < first.size(); ++g) {
        for (std::uint32_t k = first[g]; k < first[g + 1]; ++k) {
            groups[member[k]].push_back(g);
        }
    }
    first_group_.assign(1, 0);
    group_.clear();
    max_radius_ = 0.0f;
    for (const std::uint32_t i : surface_particles_) {
        group_.insert(group_.end(), groups[i].begin(), groups[i].end());
        first_group_.push_back(static_cast<std::uint32_t>(group_.size()));
        max_radius_ = std::max(max_radius_, particles.radius[i]);
    }
    at_.resize(surface_particles_.size());
    pairs_.clear();
    distance_.clear();
    pairs_.reserve(
        8 * surface_particles_.size());  // more than a closed mouth has, so that a step does not allocate
    distance_.reserve(8 * surface_particles_.size());
    grid_margin_ = -1.0f;
}

bool SelfContact::joined(std::size_t a, std::size_t b) const {
    const auto begin = group_.begin();
    auto in_a = begin + first_group_[a];
    auto in_b = begin + first_group_[b];
    const auto end_a = begin + first_group_[a + 1];
    const auto end_b = begin + first_group_[b + 1];
    while (in_a != end_a && in_b != end_b) {
        if (*in_a == *in_b) {
            return true;
        }
        *in_a < *in_b ? ++in_a : ++in_b;
    }
    return false;
}

void SelfContact::find(const Particles& particles) {
    pairs_.clear();
    distance_.clear();
    if (surface_particles_.empty()) {
        return;
    }
    if (margin != grid_margin_) {
        Vec3f low = particles.rest[surface_particles_.front()];
        Vec3f high = low;
        for (const std::uint32_t i : surface_particles_) {
            low = low.cwiseMin(particles.rest[i]);
            high = high.cwiseMax(particles.rest[i]);
        }
        const Vec3f around = Vec3f::Constant(bounds_margin);
        grid_.emplace(low - around, high + around, 2.0f * max_radius_ + margin, surface_particles_.size());
        grid_margin_ = margin;
    }
    for (std::size_t k = 0; k < surface_particles_.size(); ++k) {
        const Vec3f& at = particles.position[surface_particles_[k]];
        // Points outside the box are put at its corner, too far to be near anything.
        at_[k] = grid_->contains(at) ? at : grid_->lower();
    }
    grid_->sort(at_);
    const std::span<const std::uint32_t> order = grid_->order();
    for (std::size_t place = 0; place < order.size(); ++place) {
        const std::uint32_t a = order[place];
        const std::uint32_t i = surface_particles_[a];
        for (const CellGrid::Run& run : grid_->neighbours(grid_->cell_at(place))) {
            for (std::uint32_t other = run.first; other < run.second; ++other) {
                const std::uint32_t b = order[other];
                const std::uint32_t j = surface_particles_[b];
                if (b <= a || (particles.inverse_mass[i] == 0.0f && particles.inverse_mass[j] == 0.0f)) {
                    continue;
                }
                const float touching = std::min(particles.radius[i] + particles.radius[j],
                                                (particles.rest[i] - particles.rest[j]).norm());
                const float near = touching + margin;
                if ((particles.position[i] - particles.position[j]).squaredNorm() < near * near &&
                    !joined(a, b)) {
                    pairs_.push_back({i, j});
                    distance_.push_back(touching);
                }
            }
        }
    }
}

void SelfContact::begin_step(Particles& particles, Sleep& sleep) {
    if (!sleep.any_awake()) {
        return;
    }
    find(particles);
    for (const auto& [i, j] : pairs_) {
        if (particles.asleep[i] != particles.asleep[j] && sleep.is_moving(particles.asleep[i] != 0 ? j : i)) {
            sleep.wake(particles, particles.asleep[i] != 0 ? i : j);
        }
    }
}

void SelfContact::project(Particles& particles, float /*dt*/) {
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const auto [i, j] = pairs_[k];
        const Vec3f apart = particles.predicted[j] - particles.predicted[i];
        const float squared = apart.squaredNorm();
        if (squared >= distance_[k] * distance_[k] || squared < 1e-18f) {
            continue;
        }
        const float found = std::sqrt(squared);
        const float inverse_mass = particles.mobility(i) + particles.mobility(j);
        if (inverse_mass == 0.0f) {
            continue;  // both sleep
        }
        const Vec3f push = apart * ((distance_[k] - found) / (found * inverse_mass));
        particles.predicted[i] -= particles.mobility(i) * push;
        particles.predicted[j] += particles.mobility(j) * push;
    }
}

}  // namespace eti::pbd
