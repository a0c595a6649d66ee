// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/tools.hpp"
#include "server/pbd/contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::scene {

/// The laryngoscope's capsules against the soft tissue.
class BladeContact {
  public:
    explicit BladeContact(const Laryngoscope& scope) : scope_(scope) {}

    /// Starts a step in which the blade goes from `from` to `to`; picks the particles it can reach.
    void begin_step(const pbd::Particles& particles, const RigidTransform& from, const RigidTransform& to);

    /// Pushes particles out of the blade, which moves from `begin` to `end` (shares of the step).
    void project(pbd::Particles& particles, float begin, float end, float dt);

    /// Sums up the step of length `step_dt` [s]: the tissue's force on the blade, as minus the sum of
    /// the impulses that the particles got, and the touched particles.
    void end_step(const pbd::Particles& particles, float step_dt, Snapshot& snapshot) const;

    float friction = 0.1f;  ///< Coulomb; wet mucosa on steel

  private:
    [[nodiscard]] RigidTransform pose_at(float share) const;

    Laryngoscope scope_;
    RigidTransform from_, to_;
    std::vector<std::uint32_t> reachable_;
    std::vector<Vec3f> impulse_;            // [N s] given to each reachable particle in this step
    Vec3f torque_impulse_ = Vec3f::Zero();  // [N m s] on the particles about the tool's origin
};

}  // namespace eti::scene
