// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_tracks.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace eti::view {
namespace {

// A particle farther than this from its predicted position [spacings] is a different one.
constexpr float match_reach = 1.5f;
// A particle nearer than this to its previous position [spacings] is the same: by chance this occurs once
// in 30 thousand cases.
constexpr float unmoved = 0.02f;

}  // namespace

void LiquidTracks::advance(std::span<const Vec3f> positions, float spacing, float dt) {
    if (dt > 0.0f && std::ranges::equal(positions, positions_)) {
        rest();
        return;
    }
    previous_positions_.swap(positions_);
    previous_velocities_.swap(velocities_);
    positions_.assign(positions.begin(), positions.end());
    velocities_.assign(positions.size(), Vec3f::Zero());
    previous_indices_.assign(positions.size(), no_particle);
    next_indices_.assign(previous_positions_.size(), no_particle);
    cells_.fill(positions_, 2.0f * spacing);
    if (dt <= 0.0f) {
        return;
    }
    // Resting particles are matched first: in a lattice that has just stopped, neighbours lie at the
    // predicted positions.
    expected_ = previous_positions_;
    miss_.assign(previous_positions_.size(), std::numeric_limits<float>::max());
    match(unmoved * spacing);
    for (std::size_t i = 0; i < previous_positions_.size(); ++i) {
        expected_[i] += dt * previous_velocities_[i];
        miss_[i] = next_indices_[i] == no_particle ? miss_[i] : 0.0f;
    }
    match(match_reach * spacing);
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (previous_indices_[i] != no_particle) {
            velocities_[i] = (positions_[i] - previous_positions_[previous_indices_[i]]) / dt;
        }
    }
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (previous_indices_[i] != no_particle) {
            continue;
        }
        Vec3f sum = Vec3f::Zero();
        float count = 0.0f;
        cells_.visit_near(positions_[i], [&](std::uint32_t k) {
            if (previous_indices_[k] != no_particle) {
                sum += velocities_[k];
                count += 1.0f;
            }
        });
        velocities_[i] = count > 0.0f ? Vec3f(sum / count) : Vec3f::Zero();
    }
}

/// The same state again: all matches are identities.
void LiquidTracks::rest() {
    previous_positions_ = positions_;
    std::ranges::fill(velocities_, Vec3f(Vec3f::Zero()));
    next_indices_.resize(positions_.size());
    std::iota(next_indices_.begin(), next_indices_.end(), std::uint32_t{0});
    previous_indices_ = next_indices_;
}

/// Matches each unmatched particle to the nearest prediction within `farthest` [m]; the nearest candidate
/// wins.
void LiquidTracks::match(float farthest) {
    expected_cells_.fill(expected_, farthest);
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (previous_indices_[i] != no_particle) {
            continue;
        }
        std::uint32_t nearest = no_particle;
        float least = farthest * farthest;
        expected_cells_.visit_near(positions_[i], [&](std::uint32_t k) {
            const float squared = (expected_[k] - positions_[i]).squaredNorm();
            if (squared < least) {
                least = squared;
                nearest = k;
            }
        });
        if (nearest == no_particle || least >= miss_[nearest]) {
            continue;
        }
        if (next_indices_[nearest] != no_particle) {
            previous_indices_[next_indices_[nearest]] = no_particle;
        }
        previous_indices_[i] = nearest;
        next_indices_[nearest] = i;
        miss_[nearest] = least;
    }
}

}  // namespace eti::view
