// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid_cells.hpp"

namespace eti::view {

/// Which particle of a state is which of the state before, and so how fast it goes: states hold places alone,
/// in an order that changes. As in particle tracking velocimetry: each is sought about where its velocity
/// would have taken it, nearest first. Particles that turn by more than about half their spacing within a
/// state are taken for others; their velocity is then that of their neighbours.
class LiquidTracks {
  public:
    static constexpr std::uint32_t nobody = ~std::uint32_t{0};

    /// A state `dt` [s] after the one before; 0 begins anew, with all at rest.
    void advance(std::span<const Vec3f> positions, float spacing, float dt);

    [[nodiscard]] std::span<const Vec3f> positions() const { return positions_; }    ///< [m]
    [[nodiscard]] std::span<const Vec3f> velocities() const { return velocities_; }  ///< [m/s]
    /// Of each particle its place in the state before, or nobody.
    [[nodiscard]] std::span<const std::uint32_t> before() const { return before_; }
    /// Of each particle of the state before its place now, or nobody.
    [[nodiscard]] std::span<const std::uint32_t> after() const { return after_; }
    /// Where particles were in the state before.
    [[nodiscard]] std::span<const Vec3f> former() const { return former_; }
    /// Of the newest state, two spacings wide.
    [[nodiscard]] const LiquidCells& cells() const { return cells_; }

  private:
    void match(float farthest);
    void rest();

    std::vector<Vec3f> positions_, velocities_, former_, former_velocities_, expected_;
    std::vector<std::uint32_t> before_, after_;
    std::vector<float> miss_;  // [m^2], by which the former particle was missed
    LiquidCells cells_, expected_cells_;
};

}  // namespace eti::view
