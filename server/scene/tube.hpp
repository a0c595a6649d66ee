// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/rod.hpp"

namespace eti::scene {

/// The tube against shell, soft tissue and blade.
class TubeContact {
  public:
    TubeContact(const Tube& tube, const Laryngoscope& scope, const RigidTransform& grip);

    /// Starts a step in which grip and blade go from one pose to the other.
    void begin_step(const pbd::Particles& particles, const RigidTransform& grip_from,
                    const RigidTransform& grip_to, const RigidTransform& blade_from,
                    const RigidTransform& blade_to);
    /// Moves the rod to where it would be at `share` of the step, `dt` [s] after the last substep.
    void predict(float dt, float share);
    /// Joints of the rod and its contacts; contacts last, so that nothing penetrates in the end.
    void project(pbd::Particles& particles, const DistanceGrid& shell, float share);
    void finish() { rod_.finish(); }

    void reset(const RigidTransform& grip);
    void nodes(std::vector<Vec3f>& out) const;

  private:
    void meet_shell(const DistanceGrid& shell);
    void meet_blade(const RigidTransform& blade);
    void meet_tissue(pbd::Particles& particles);

    Laryngoscope scope_;
    pbd::Rod rod_;
    RigidTransform grip_from_, grip_to_, blade_from_, blade_to_;
    std::vector<std::uint32_t> reachable_;  ///< particles near the tube in this step
    bool near_blade_ = false;
};

}  // namespace eti::scene
