// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/scene.hpp"

namespace eti::bench {

/// The scene with the laryngoscope at rest at the best view.
struct LiftState {
    std::vector<Vec3d> position;  ///< [m], of all particles, mean over the end
    std::vector<bool> touched;    ///< touched by the blade at any time of the end
    Vec3d force = Vec3d::Zero();  ///< [N], of the tongue on the blade
    double opening = 0.0;         ///< POGO [%]
    double speed = 0.0;           ///< [m/s], RMS, of what should be at rest
    double frame_ms = 0.0;        ///< wall time per simulated 1/90 s
};

/// A tongue's surroundings along a blade's path, from a run of the scene: everything that finite elements do
/// not move, and the blade, which tissue does not move.
struct Surroundings {
    std::vector<bool> free;  ///< by particle, whether finite elements move it
    std::vector<std::uint32_t>
        held;  ///< particles that hold the tongue: the mesh's others, and those it is linked to
    std::vector<RigidTransform> blade;  ///< by step
    std::vector<std::vector<Vec3f>>
        held_at;  ///< [m], by step, of those held; the last is the mean over the end
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< of the surface, between free particles
    std::vector<std::uint32_t> meets_shell;
    DistanceGrid shell;
    Laryngoscope scope;
    std::vector<Vec3f> rest;   ///< [m], of all particles, in the posture
    scene::Snapshot snapshot;  ///< of the last step
    std::vector<scene::SoftTissue>
        tissue;  ///< one, of the last step, with all particles at their mean positions
};

/// The expert's laryngoscope from the start until the best view of the glottis, tube parked.
[[nodiscard]] std::vector<scene::Inputs> lift_of(const Scenario& scenario, const patient::Patient& patient);

/// The tongue's surroundings along that path, from the solver as in the scenario.
[[nodiscard]] Surroundings surroundings_of(const Scenario& scenario, const patient::Patient& patient,
                                           const std::vector<scene::Inputs>& way);

/// The solver's result; forces and speeds are those of the particles `counted`.
[[nodiscard]] LiftState simulate_lift(const Scenario& scenario, const patient::Patient& patient,
                                      const std::vector<scene::Inputs>& way,
                                      const std::vector<bool>& counted);

/// POGO [%] of a snapshot.
[[nodiscard]] double opening_of(const patient::Patient& patient, const Laryngoscope& scope,
                                const scene::Snapshot& snapshot);

}  // namespace eti::bench
