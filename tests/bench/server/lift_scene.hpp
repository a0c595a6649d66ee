// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/scene.hpp"

namespace eti::bench {

/// The scene as the laryngoscope stands still at the best view.
struct Lift {
    std::vector<Vec3d> position;  ///< [m], of all particles, mean over the end
    std::vector<bool> touched;    ///< by the blade, at any time of the end
    Vec3d force = Vec3d::Zero();  ///< [N], of the tongue on the blade
    double opening = 0.0;         ///< POGO [%]
    double speed = 0.0;           ///< [m/s], rms, of what ought to stand still
    double frame_ms = 0.0;        ///< wall time per simulated 1/90 s
};

/// A tongue's surroundings on a blade's way: what finite elements are not asked to move, from a run of the
/// scene, and the blade, which tissue does not move.
struct Surroundings {
    std::vector<bool> free;             ///< by particle, whether finite elements move it
    std::vector<std::uint32_t> held;    ///< particles that hold the tongue: the mesh's others, and
                                        ///< what links tie it to
    std::vector<RigidTransform> blade;  ///< by step
    std::vector<std::vector<Vec3f>>
        held_at;  ///< [m], by step, of those held; the last is the mean over the end
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< of the surface, of particles that are free
    std::vector<std::uint32_t> meets_shell;
    DistanceGrid shell;
    Laryngoscope scope;
    std::vector<Vec3f> rest;                ///< [m], of all particles, in the posture
    scene::Snapshot snapshot;               ///< of the last step
    std::vector<scene::SoftTissue> tissue;  ///< one, of the last step, with all in its mean place
};

/// The expert's laryngoscope from the start until the glottis is seen best, tube parked.
[[nodiscard]] std::vector<scene::Inputs> lift_of(const Scenario& scenario, const anatomy::Patient& patient);

/// What surrounds the tongue on that way, as the solver has it with so many substeps and such a tongue.
[[nodiscard]] Surroundings surroundings_of(const Scenario& scenario, const anatomy::Patient& patient,
                                           const std::vector<scene::Inputs>& way, TissueMethod model,
                                           int substeps);

/// What the solver makes of it; of forces and speeds those of particles `counted`.
[[nodiscard]] Lift by_particles(const Scenario& scenario, const anatomy::Patient& patient,
                                const std::vector<scene::Inputs>& way, const std::vector<bool>& counted);

/// POGO [%] of a snapshot.
[[nodiscard]] double opening_of(const anatomy::Patient& patient, const Laryngoscope& scope,
                                const scene::Snapshot& snapshot);

}  // namespace eti::bench
