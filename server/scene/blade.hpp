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

/// The laryngoscope's capsules against the soft tissue: its particles, and the edges between those on its
/// surface, so that no blade slips in between particles that it has pressed apart.
class BladeContact {
  public:
    using Edge = std::array<std::uint32_t, 2>;  ///< particles

    explicit BladeContact(const Laryngoscope& scope, std::vector<Edge> edges = {});

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
    void move(pbd::Particles& particles, std::uint32_t particle, const Vec3f& push);

    Laryngoscope scope_;
    RigidTransform from_, to_;
    /// An edge and a capsule that may meet in this step; for a particle both ends are that particle.
    struct Meeting {
        std::uint32_t first, second;
        std::uint32_t capsule;
    };

    std::vector<Edge> edges_;
    std::vector<Meeting> particle_meetings_, edge_meetings_;
    std::vector<std::uint32_t> reachable_;  // particles
    std::vector<std::uint32_t> number_of_;  // by particle: its place in reachable_, or none
    std::vector<Vec3f> push_;               // [m] by which each reachable particle was moved in this substep
    std::vector<Vec3f> impulse_;            // [N s] given to it in this step
    Vec3f torque_impulse_ = Vec3f::Zero();  // [N m s] on the particles about the tool's origin
};

}  // namespace eti::scene
