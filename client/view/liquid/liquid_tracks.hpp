// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid/spatial_hash.hpp"

namespace eti::view {

/// Matches particles between successive states, which contain only positions in varying order, and derives
/// velocities. As in particle tracking velocimetry, each particle is sought near its predicted position,
/// nearest first. A particle that changes course by more than about half the spacing within a state is not
/// matched; it takes its neighbours' velocity.
class LiquidTracks {
  public:
    static constexpr std::uint32_t no_particle = ~std::uint32_t{0};

    /// Advances to a state `dt` [s] after the last; 0 restarts, with all at rest.
    void advance(std::span<const Vec3f> positions, float spacing, float dt);

    [[nodiscard]] std::span<const Vec3f> positions() const { return positions_; }    ///< [m]
    [[nodiscard]] std::span<const Vec3f> velocities() const { return velocities_; }  ///< [m/s]
    /// By particle: its index in the previous state, or no_particle.
    [[nodiscard]] std::span<const std::uint32_t> previous_indices() const { return previous_indices_; }
    /// By particle of the previous state: its current index, or no_particle.
    [[nodiscard]] std::span<const std::uint32_t> next_indices() const { return next_indices_; }
    /// Positions in the previous state.
    [[nodiscard]] std::span<const Vec3f> previous_positions() const { return previous_positions_; }
    /// Hash of the newest state, cell size two spacings.
    [[nodiscard]] const SpatialHash& cells() const { return cells_; }

  private:
    void match(float farthest);
    void rest();

    std::vector<Vec3f> positions_, velocities_, previous_positions_, previous_velocities_, expected_;
    std::vector<std::uint32_t> previous_indices_, next_indices_;
    std::vector<float> miss_;  // [m^2] squared prediction error, by previous particle
    SpatialHash cells_, expected_cells_;
};

}  // namespace eti::view
