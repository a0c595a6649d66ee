// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/tools.hpp"
#include "server/pbd/contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/soft_body.hpp"
#include "server/scene/friction.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::scene {

/// The laryngoscope's capsules against the soft tissue: its particles, and the edges between those on its
/// surface, so that no blade slips in between particles that it has pressed apart.
class BladeContact {
  public:
    using Edge = std::array<std::uint32_t, 2>;  ///< particles

    /// `met_elsewhere`, by particle: those that somebody else keeps out of the blade; empty: none.
    explicit BladeContact(const Laryngoscope& scope, std::vector<Edge> edges = {},
                          std::vector<bool> met_elsewhere = {});

    /// Wakes tissue that the blade may meet on its way from `from` to `to`. Before begin_step().
    void wake(pbd::SoftBody& body, const RigidTransform& from, const RigidTransform& to) const;

    /// Starts a step in which the blade goes from `from` to `to`; picks the particles it can reach.
    void begin_step(const pbd::Particles& particles, const RigidTransform& from, const RigidTransform& to);

    /// Pushes particles out of the blade, which moves from `begin` to `end` (shares of the step).
    void project(pbd::Particles& particles, float begin, float end, float dt);

    /// An impulse [N s] that the blade, now at `pose`, gave to a particle at `position` where others had it
    /// stopped by the blade.
    void add_impulse(std::uint32_t particle, const Vec3f& position, const Vec3f& impulse,
                     const RigidTransform& pose);

    [[nodiscard]] const Laryngoscope& scope() const { return scope_; }
    /// Whether it may touch a particle in this step.
    [[nodiscard]] bool reaches_tissue() const { return !reachable_.empty(); }
    /// [m], that it goes in this step where there is tissue near.
    [[nodiscard]] float way() const { return way_; }
    /// Where the blade is after this share of the step.
    [[nodiscard]] RigidTransform pose_at(float share) const;

    /// Sums up the step of length `step_dt` [s]: the tissue's force on the blade, as minus the sum of
    /// the impulses that the particles got, and the touched particles.
    void end_step(const pbd::Particles& particles, float step_dt, Snapshot& snapshot) const;

    pbd::Friction friction = mucosa_on_steel;

  private:
    /// What was known of a pair when its distance was last computed. Until particles and blade have gone that
    /// far together they cannot meet, which is cheaper to tell than to compute it again.
    struct Clearance {
        std::array<Vec3f, 2> seen = {Vec3f::Zero(), Vec3f::Zero()};  ///< [m], the particles
        float gap = -1.0f;                                           ///< [m], from the blade's surface
        float travelled = 0.0f;                                      ///< [m], by the blade in this step
    };
    struct Motion {
        float so_far = 0.0f, now = 0.0f;  ///< [m], way of the farthest point in this step and in this substep
    };

    [[nodiscard]] static bool out_of_reach(const pbd::Particles& particles, std::uint32_t first,
                                           std::uint32_t second, const Clearance& last, const Motion& blade);
    void meet_edges(pbd::Particles& particles, const std::array<pbd::MovingCapsule, 3>& capsules);
    void meet_particles(pbd::Particles& particles, const std::array<pbd::MovingCapsule, 3>& capsules);
    void move(pbd::Particles& particles, std::uint32_t particle, const Vec3f& push);

    Laryngoscope scope_;
    RigidTransform from_, to_;
    float way_ = 0.0f;  // [m]
    /// An edge and a capsule that may meet in this step.
    struct EdgeMeeting {
        std::uint32_t first, second;
        std::uint32_t capsule;
        Clearance clearance;
    };
    /// A particle and the capsules that it may meet.
    struct ParticleMeeting {
        std::uint32_t particle;
        std::array<bool, 3> capsule = {};
        Clearance clearance;
    };

    std::vector<Edge> edges_;                // sorted
    std::vector<bool> met_elsewhere_;        // by particle, or empty
    std::vector<std::uint32_t> first_edge_;  // by particle: the first edge that begins there
    std::vector<ParticleMeeting> particle_meetings_;
    std::vector<EdgeMeeting> edge_meetings_;
    Motion motion_;
    std::vector<std::uint32_t> reachable_;  // particles
    std::vector<std::uint32_t> number_of_;  // by particle: its place in reachable_, or none
    std::vector<Vec3f> push_;               // [m] by which each reachable particle was moved in this substep
    std::vector<Vec3f> impulse_;            // [N s] given to it in this step
    Vec3f torque_impulse_ = Vec3f::Zero();  // [N m s] on the particles about the tool's origin
};

}  // namespace eti::scene
