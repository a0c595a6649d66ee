// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "tests/bench/server/accuracy/lift_scene.hpp"
#include "tests/validation/fem/friction_path.hpp"

namespace eti::bench {

/// How finite elements follow the blade's path. The augmented Lagrangian determines the final contact depth:
/// the stiffness only affects convergence and the cost of a step.
struct LiftSettings {
    double increment = 1e-3;   ///< [m], maximum motion of the blade's farthest point in one step,
    std::size_t longest = 12;  ///< and maximum number of the scene's steps of 1/180 s
    double drag = 1.0;         ///< relative to the scene's damping
    double stiffness = 500.0;  ///< [N/m], of each contact with the blade
    double sticking = 250.0;   ///< [N/m], tangential, while it sticks
    double shell = 2e3;        ///< [N/m], penalty stiffness of each vertex on the shell
    double on_the_way = 1e-3;  ///< bound for the largest unbalanced force, relative to the largest force;
    double at_rest = 1e-5;     ///< the same at the end
};

/// The tongue on the blade's path by finite elements on its own mesh, in time as a body slowed down by the
/// scene's damping (inertia is negligible beside it), and at the end in equilibrium. Contacts with blade and
/// shell and friction are solved independently of the solver's run; links are springs. Vertices held by
/// clusters or bones follow the surroundings.
class LiftReference {
  public:
    LiftReference(const Scenario& scenario, const patient::Patient& patient, const Surroundings& surroundings,
                  const LiftSettings& choice);

    LiftState lift;  ///< at the end

    /// RMS over the particles that finite elements move, relative to their displacement.
    [[nodiscard]] double apart(const LiftState& other) const;
    /// [N], of the tongue on the blade, from the material's stress at another solver's positions: the force
    /// that holds the particles touched by the blade.
    [[nodiscard]] Vec3d material(const LiftState& other) const;
    [[nodiscard]] const std::vector<bool>& free() const { return surroundings_.free; }

    double penetration = 0.0;  ///< [m], maximum at the end
    double still = 0.0;        ///< relative change of the force on the blade in the last, longest step
    int increments = 0;
    int iterations = 0;

  private:
    void make_problem(const Scenario& scenario, const patient::Patient& patient);
    /// The blade's pose at a time in steps, and the positions of held vertices.
    [[nodiscard]] Eigen::Isometry3d blade_at(double step) const;
    [[nodiscard]] std::vector<double> held_at(double step) const;
    /// Advances from one time to another, bisecting where a step does not converge.
    void go(double from, double to);
    /// Solves for equilibrium with all surroundings at rest in their final position.
    void come_to_rest();
    /// Steps of the path at which positions are needed.
    [[nodiscard]] std::vector<std::size_t> stops() const;
    [[nodiscard]] Vec3d force_on_blade() const;

    const Surroundings& surroundings_;
    LiftSettings choice_;
    std::vector<std::uint32_t> number_;    // by particle: its vertex, or none
    std::vector<std::uint32_t> particle_;  // by vertex
    fem::PathProblem problem_;
    std::unique_ptr<fem::Solid> shell_;
    std::unique_ptr<fem::FrictionPath> path_;
};

}  // namespace eti::bench
