// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "tests/bench/server/lift_scene.hpp"
#include "tests/validation/fem/friction_path.hpp"

namespace eti::bench {

/// How finite elements go the blade's way. Contacts with multipliers end up as deep as these leave them:
/// their stiffness only says how fast, and how hard a step is to solve.
struct LiftChoice {
    double increment = 1e-3;   ///< [m], most of the blade's farthest point in one step,
    std::size_t longest = 12;  ///< and most of the scene's steps of 1/180 s
    double drag = 1.0;         ///< in parts of the scene's damping
    double stiffness = 500.0;  ///< [N/m], of each contact with the blade
    double sticking = 250.0;   ///< [N/m], along each, while it sticks
    double shell = 2e3;        ///< [N/m], with which each vertex on the shell is pushed back
    double on_the_way = 1e-3;  ///< bound for the largest unbalanced force, in parts of the largest force;
    double at_rest = 1e-5;     ///< the same at the end
};

/// The tongue on the blade's way by finite elements on its own mesh, in time as a body slowed down by the
/// scene's damping (and without inertia, which that leaves little of), and at the end in equilibrium. Blade,
/// shell and friction are met anew, not taken from the solver's run; links are springs. What clusters or
/// bones hold is where the surroundings have it.
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
    double still = 0.0;        ///< change of the force on the blade in the last, longest step, in parts of it
    int increments = 0;
    int iterations = 0;

  private:
    void make_problem(const Scenario& scenario, const anatomy::Patient& patient);
    /// The blade at a time in steps, and where held vertices then are.
    [[nodiscard]] Eigen::Isometry3d blade_at(double step) const;
    [[nodiscard]] std::vector<double> held_at(double step) const;
    /// From one time to another, by more between where a step is not found at once.
    void go(double from, double to);
    /// To the equilibrium with all that holds it at rest in its last place.
    void come_to_rest();
    /// Steps of the way, where places are wanted.
    [[nodiscard]] std::vector<std::size_t> stops() const;
    [[nodiscard]] Vec3d force_on_blade() const;

    const Surroundings& surroundings_;
    LiftChoice choice_;
    std::vector<std::uint32_t> number_;    // by particle: of the vertex, or none
    std::vector<std::uint32_t> particle_;  // by vertex
    fem::PathProblem problem_;
    std::unique_ptr<fem::Solid> shell_;
    std::unique_ptr<fem::FrictionPath> path_;
};

}  // namespace eti::bench
