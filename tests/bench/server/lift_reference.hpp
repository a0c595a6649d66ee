// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "tests/bench/server/lift_scene.hpp"
#include "tests/validation/fem/friction_path.hpp"

namespace eti::bench {

/// How finite elements go the blade's way.
struct LiftChoice {
    double increment = 2e-3;       ///< [m], of the blade's farthest point, from equilibrium to equilibrium
    double penetration = 0.02e-3;  ///< [m], bound for the deepest contact
    double stiffness = 2e3;        ///< [N/m], of each contact
    double sticking = 1e3;         ///< [N/m], along each, while it sticks
    bool edges = true;             ///< whether edges meet the blade, or only particles
    bool friction = true;
};

/// The tongue's equilibria along the blade's way by finite elements on its own mesh. Blade, shell and
/// friction are met anew, not taken from the solver's run; links are springs. What clusters or bones hold is
/// where the surroundings have it.
class LiftReference {
  public:
    LiftReference(const Scenario& scenario, const anatomy::Patient& patient, const Surroundings& surroundings,
                  const LiftChoice& choice);

    Lift lift;  ///< at the end

    /// Root mean square over the particles that finite elements move, in parts of their displacement.
    [[nodiscard]] double apart(const Lift& other) const;
    /// [N], of the tongue on the blade, as the material has it where another has brought it: what holds those
    /// in place that the blade touches.
    [[nodiscard]] Vec3d material(const Lift& other) const;
    [[nodiscard]] const std::vector<bool>& free() const { return surroundings_.free; }

    double penetration = 0.0;  ///< [m], deepest, at the end
    int increments = 0;
    int iterations = 0;

  private:
    void make_problem(const Scenario& scenario, const anatomy::Patient& patient, const LiftChoice& choice);
    /// To the equilibrium at a step of the way, by more between where it is not found at once.
    void go(std::size_t from, std::size_t to);
    /// Steps of the way, where equilibria are wanted.
    [[nodiscard]] std::vector<std::size_t> stops(double increment) const;

    const Surroundings& surroundings_;
    std::vector<std::uint32_t> number_;    // by particle: of the vertex, or none
    std::vector<std::uint32_t> particle_;  // by vertex
    fem::PathProblem problem_;
    std::unique_ptr<fem::Solid> shell_;
    std::unique_ptr<fem::FrictionPath> path_;
};

}  // namespace eti::bench
