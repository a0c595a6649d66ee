// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/pbd/cell_grid.hpp"
#include "server/pbd/constraint.hpp"

namespace eti::pbd {

/// Keeps tissue out of tissue: two particles that no constraint joins stay as far apart as their radii say,
/// or as they are at rest where that is less. One-sided distance constraints (Müller et al. 2007, "Position
/// based dynamics", 3.3) without friction: mucosa is wet.
class SelfContact final : public Constraint {
  public:
    /// [m]; half of it in a step of 1/180 s is 0.18 m/s. Larger: faster tissue is still met, and more pairs
    /// are looked at.
    float margin = 2e-3f;

    /// `who`: particles that lie at the surface; `groups`: particles that are joined to each other, as
    /// first[g] .. first[g + 1] of `member`. Pairs of one group never meet.
    void configure(std::vector<std::uint32_t> who, std::span<const std::uint32_t> first,
                   std::span<const std::uint32_t> member, const Particles& particles);

    /// Lists the pairs that may meet until the next call while none of their particles moves farther than
    /// half of the margin.
    void find(const Particles& particles);
    [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }

    /// Finds pairs, unless all sleep, and wakes what sleeps beside something that stirs.
    void begin_step(Particles& particles, Sleep& sleep) override;
    /// Moves listed pairs apart, each by its inverse masses, one after the other.
    void project(Particles& particles, float dt) override;

  private:
    [[nodiscard]] bool joined(std::size_t a, std::size_t b) const;

    std::vector<std::uint32_t> who_;
    std::vector<std::uint32_t> first_group_, group_;  // of each of who_, ascending
    float widest_ = 0.0f;                             // [m], largest radius
    std::optional<CellGrid> grid_;
    float grid_margin_ = -1.0f;  // [m], what the grid's cells are made for
    std::vector<Vec3f> at_;
    std::vector<Pair> pairs_;      // in the order of who_
    std::vector<float> distance_;  // [m], kept by each pair
};

}  // namespace eti::pbd
