// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/friction.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::scene {

/// Contact of the laryngoscope's capsules with the soft tissue: its particles, and the edges between surface
/// particles, so that no blade slips between particles that it has pressed apart. Not thread safe: the
/// physics thread calls all functions, except that begin_step() and project() may run concurrently with those
/// of the tube.
class BladeContact {
  public:
    using Edge = std::array<std::uint32_t, 2>;  ///< particle indices

    /// `excluded` [particles]: true for particles whose blade contact another solver handles; empty: none.
    explicit BladeContact(const Laryngoscope& scope, std::vector<Edge> edges = {},
                          std::vector<bool> excluded = {});

    /// Wakes tissue that the blade may touch on its way from `from` to `to`. Call before begin_step().
    void wake(pbd::SoftBody& body, const RigidTransform& from, const RigidTransform& to) const;

    /// Forgets the impulses of the last step.
    void reset();

    /// Starts a step in which the blade moves from `from` to `to`; selects the particles within reach.
    void begin_step(const pbd::Particles& particles, const RigidTransform& from, const RigidTransform& to);

    /// Projects particles out of the blade, which moves from `begin` to `end` (fractions of the step).
    void project(pbd::Particles& particles, float begin, float end, float dt);

    /// Adds an impulse [N s] that the blade, at `pose`, exerted on a particle at `position` in another
    /// solver.
    void add_impulse(std::uint32_t particle, const Vec3f& position, const Vec3f& impulse,
                     const RigidTransform& pose);

    /// Calls body(particle, impulse [N s]) for the particles that the blade pushed in the last step.
    template <class Body>
    void for_impulses(const Body& body) const {
        for (std::size_t n = 0; n < reachable_.size(); ++n) {
            if (!impulse_[n].isZero(0.0f)) {
                body(reachable_[n], impulse_[n]);
            }
        }
    }

    [[nodiscard]] const Laryngoscope& scope() const { return scope_; }
    /// Whether the blade may touch a particle in this step.
    [[nodiscard]] bool reaches_tissue() const { return !reachable_.empty(); }
    /// Travel of the blade in this step where tissue is near [m].
    [[nodiscard]] float travel() const { return travel_; }
    /// Pose of the blade at this fraction of the step.
    [[nodiscard]] RigidTransform pose_at(float share) const;

    /// Completes the step of length `step_dt` [s]: writes the tissue's force on the blade, minus the sum of
    /// the impulses on the particles, and the touched particles to `snapshot`.
    void end_step(const pbd::Particles& particles, float step_dt, Snapshot& snapshot) const;

    pbd::Friction friction = mucosa_on_steel;

  private:
    /// Cached distance of a pair. Until particles and blade together have travelled that far they cannot
    /// touch, which is cheaper to test than to recompute the distance.
    struct Clearance {
        std::array<Vec3f, 2> seen = {Vec3f::Zero(), Vec3f::Zero()};  ///< [m], the particles' positions
        float gap = -1.0f;                                           ///< [m], to the blade's surface
        float travelled = 0.0f;                                      ///< [m], the blade's travel in this step
    };
    struct Motion {
        float in_step = 0.0f,
              now = 0.0f;  ///< [m], travel of the farthest point in this step and in this substep
    };

    [[nodiscard]] static bool out_of_reach(const pbd::Particles& particles, std::uint32_t first,
                                           std::uint32_t second, const Clearance& last, const Motion& blade);
    void collide_edges(pbd::Particles& particles, const std::array<pbd::MovingCapsule, 3>& capsules);
    void collide_particles(pbd::Particles& particles, const std::array<pbd::MovingCapsule, 3>& capsules);
    void move(pbd::Particles& particles, std::uint32_t particle, const Vec3f& push);

    Laryngoscope scope_;
    RigidTransform from_, to_;
    float travel_ = 0.0f;  // [m]
    /// An edge and a capsule that may touch in this step.
    struct EdgeCandidate {
        std::uint32_t first, second;
        std::uint32_t capsule;
        Clearance clearance;
    };
    /// A particle and the capsules that it may touch.
    struct ParticleCandidate {
        std::uint32_t particle;
        std::array<bool, 3> capsule = {};
        Clearance clearance;
    };

    std::vector<Edge> edges_;                // [edges], sorted
    std::vector<bool> excluded_;             // [particles], or empty
    std::vector<std::uint32_t> first_edge_;  // [particles]: index of the first edge that begins there
    std::vector<ParticleCandidate> particle_candidates_;
    std::vector<EdgeCandidate> edge_candidates_;
    Motion motion_;
    std::vector<std::uint32_t> reachable_;        // particle indices
    std::vector<std::uint32_t> reachable_index_;  // [particles]: index in reachable_, or none
    std::vector<Vec3f> push_;                     // [reachable_][m], displacement in this substep
    std::vector<Vec3f> impulse_;                  // [reachable_][N s], in this step
    Vec3f torque_impulse_ = Vec3f::Zero();        // [N m s], on the particles, about the tool's origin
};

}  // namespace eti::scene
