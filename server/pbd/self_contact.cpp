// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/self_contact.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/sleep.hpp"

namespace eti::pbd {

namespace {

constexpr float wander = 0.03f;  // [m] that tissue may leave the box it rests in and still be looked at

}  // namespace

void SelfContact::configure(std::vector<std::uint32_t> who, std::span<const std::uint32_t> first,
                            std::span<const std::uint32_t> member, const Particles& particles) {
    who_ = std::move(who);
    std::vector<std::vector<std::uint32_t>> groups(particles.size());
    for (std::uint32_t g = 0; g + 1 < first.size(); ++g) {
        for (std::uint32_t k = first[g]; k < first[g + 1]; ++k) {
            groups[member[k]].push_back(g);
        }
    }
    first_group_.assign(1, 0);
    group_.clear();
    widest_ = 0.0f;
    for (const std::uint32_t i : who_) {
        group_.insert(group_.end(), groups[i].begin(), groups[i].end());
        first_group_.push_back(static_cast<std::uint32_t>(group_.size()));
        widest_ = std::max(widest_, particles.radius[i]);
    }
    at_.resize(who_.size());
    pairs_.clear();
    distance_.clear();
    pairs_.reserve(8 * who_.size());  // more than a mouth closed on itself has: a step allocates nothing
    distance_.reserve(8 * who_.size());
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
    if (who_.empty()) {
        return;
    }
    if (margin != grid_margin_) {
        Vec3f low = particles.rest[who_.front()];
        Vec3f high = low;
        for (const std::uint32_t i : who_) {
            low = low.cwiseMin(particles.rest[i]);
            high = high.cwiseMax(particles.rest[i]);
        }
        const Vec3f around = Vec3f::Constant(wander);
        grid_.emplace(low - around, high + around, 2.0f * widest_ + margin, who_.size());
        grid_margin_ = margin;
    }
    for (std::size_t k = 0; k < who_.size(); ++k) {
        const Vec3f& at = particles.position[who_[k]];
        // What has left the box stays behind at its edge: too far off to be found near anything.
        at_[k] = grid_->contains(at) ? at : grid_->lower();
    }
    grid_->sort(at_);
    const std::span<const std::uint32_t> order = grid_->order();
    for (std::size_t place = 0; place < order.size(); ++place) {
        const std::uint32_t a = order[place];
        const std::uint32_t i = who_[a];
        for (const CellGrid::Run& run : grid_->neighbours(grid_->cell_at(place))) {
            for (std::uint32_t other = run.first; other < run.second; ++other) {
                const std::uint32_t b = order[other];
                const std::uint32_t j = who_[b];
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
        if (particles.asleep[i] != particles.asleep[j] && sleep.stirs(particles.asleep[i] != 0 ? j : i)) {
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
