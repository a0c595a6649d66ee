// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/constraint.hpp"

namespace eti::pbd {

/// XPBD distance constraint (Macklin et al. 2016, eq. 18) with one iteration per substep: moves both
/// ends so that their distance approaches `length` [m] with stiffness `stiffness` [N/m].
void project_link(Vec3f& a, Vec3f& b, float inverse_mass_a, float inverse_mass_b, float length,
                  float stiffness, float dt);

/// Distance constraints between pairs of particles, projected sequentially (Gauss-Seidel).
class Links final : public Constraint {
  public:
    void configure(std::vector<Pair> ends, std::vector<float> stiffness, const Particles& particles);
    [[nodiscard]] std::span<const Pair> coupled_pairs() const override { return ends_; }
    void set_rest(const Particles& particles) override;
    /// Sets the stiffnesses [links][N/m].
    void set_stiffness(std::span<const float> stiffness);
    void select(const Particles& particles) override;
    void project(Particles& particles, float dt) override;
    [[nodiscard]] std::size_t size() const { return ends_.size(); }

  private:
    std::vector<Pair> ends_;                 // [links]
    std::vector<float> stiffness_, length_;  // [links][N/m], [links][m] at rest
    /// Order of projection, mostly as configured, so that a pass propagates along chains of links; of all
    /// links, and of awake links.
    std::vector<std::uint32_t> order_, awake_;
    /// [links][m], ends of a link when the last pass projected it. A sleeping link is projected with these:
    /// they are its state in the middle of the pass, in balance, not at the pass's end.
    std::vector<std::array<Vec3f, 2>> met_;
    std::vector<float> compliance_;  ///< [links][1/kg], for a substep of
    float compliance_dt_ = 0.0f;     ///< [s]
};

}  // namespace eti::pbd
