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

/// Contact between tissue and tissue: two particles that no constraint joins keep a distance of the sum of
/// their radii, or their rest distance where that is smaller. Unilateral distance constraints (Müller et al.
/// 2007, "Position based dynamics", 3.3) without friction: mucosa is wet.
class SelfContact final : public Constraint {
  public:
    /// [m]; half of it per step of 1/180 s is 0.18 m/s. A larger margin handles faster tissue, and tests more
    /// pairs.
    float margin = 2e-3f;

    /// `who`: surface particles. `groups`: particles joined to each other, group g being first[g] .. first[g
    /// + 1] of `member`. Pairs within a group never collide.
    void configure(std::vector<std::uint32_t> who, std::span<const std::uint32_t> first,
                   std::span<const std::uint32_t> member, const Particles& particles);

    /// Lists candidate pairs; valid until the next call while no particle moves more than half the margin.
    void find(const Particles& particles);
    [[nodiscard]] std::span<const Pair> pairs() const { return pairs_; }

    /// Finds pairs unless all particles sleep; wakes sleeping particles next to moving ones.
    void begin_step(Particles& particles, Sleep& sleep) override;
    /// Separates the listed pairs, weighted by inverse mass, sequentially.
    void project(Particles& particles, float dt) override;

  private:
    [[nodiscard]] bool joined(std::size_t a, std::size_t b) const;

    std::vector<std::uint32_t> surface_particles_;
    std::vector<std::uint32_t> first_group_, group_;  // groups of each surface particle, ascending
    float max_radius_ = 0.0f;                         // [m], largest particle radius
    std::optional<CellGrid> grid_;
    float grid_margin_ = -1.0f;  // [m], margin for which the grid's cells were built
    std::vector<Vec3f> at_;
    std::vector<Pair> pairs_;      // in the order of surface_particles_
    std::vector<float> distance_;  // [m], minimum distance of each pair
};

}  // namespace eti::pbd
