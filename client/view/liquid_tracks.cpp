// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid_tracks.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace eti::view {
namespace {

// Farther than this from where it was expected [spacings], a particle is another one.
constexpr float match_reach = 1.5f;
// Nearer than this to where it was [spacings], it is the same: chance does so once in 30 thousand times.
constexpr float unmoved = 0.02f;

}  // namespace

void LiquidTracks::advance(std::span<const Vec3f> positions, float spacing, float dt) {
    if (dt > 0.0f && std::ranges::equal(positions, positions_)) {
        rest();
        return;
    }
    former_.swap(positions_);
    former_velocities_.swap(velocities_);
    positions_.assign(positions.begin(), positions.end());
    velocities_.assign(positions.size(), Vec3f::Zero());
    before_.assign(positions.size(), nobody);
    after_.assign(former_.size(), nobody);
    cells_.fill(positions_, 2.0f * spacing);
    if (dt <= 0.0f) {
        return;
    }
    // What rests comes first: amid a lattice that has just stopped, neighbours lie where it would have gone.
    expected_ = former_;
    miss_.assign(former_.size(), std::numeric_limits<float>::max());
    match(unmoved * spacing);
    for (std::size_t i = 0; i < former_.size(); ++i) {
        expected_[i] += dt * former_velocities_[i];
        miss_[i] = after_[i] == nobody ? miss_[i] : 0.0f;
    }
    match(match_reach * spacing);
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (before_[i] != nobody) {
            velocities_[i] = (positions_[i] - former_[before_[i]]) / dt;
        }
    }
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (before_[i] != nobody) {
            continue;
        }
        Vec3f sum = Vec3f::Zero();
        float count = 0.0f;
        cells_.around(positions_[i], [&](std::uint32_t k) {
            if (before_[k] != nobody) {
                sum += velocities_[k];
                count += 1.0f;
            }
        });
        velocities_[i] = count > 0.0f ? Vec3f(sum / count) : Vec3f::Zero();
    }
}

/// The same state again: everybody is who it was.
void LiquidTracks::rest() {
    former_ = positions_;
    std::ranges::fill(velocities_, Vec3f(Vec3f::Zero()));
    after_.resize(positions_.size());
    std::iota(after_.begin(), after_.end(), std::uint32_t{0});
    before_ = after_;
}

/// Those without a former particle find the nearest within `farthest` [m] of where it was expected; who comes
/// nearest to it is it.
void LiquidTracks::match(float farthest) {
    expected_cells_.fill(expected_, farthest);
    for (std::uint32_t i = 0; i < positions_.size(); ++i) {
        if (before_[i] != nobody) {
            continue;
        }
        std::uint32_t nearest = nobody;
        float least = farthest * farthest;
        expected_cells_.around(positions_[i], [&](std::uint32_t k) {
            const float squared = (expected_[k] - positions_[i]).squaredNorm();
            if (squared < least) {
                least = squared;
                nearest = k;
            }
        });
        if (nearest == nobody || least >= miss_[nearest]) {
            continue;
        }
        if (after_[nearest] != nobody) {
            before_[after_[nearest]] = nobody;
        }
        before_[i] = nearest;
        after_[nearest] = i;
        miss_[nearest] = least;
    }
}

}  // namespace eti::view
