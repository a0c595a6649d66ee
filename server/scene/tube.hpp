// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/rod/rod.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/skeleton/wall_motion.hpp"

namespace eti::scene {

/// Contact of the tube with shell, blade and soft tissue. All contacts are solved together with the rod. Not
/// thread safe: the physics thread calls all functions, except that begin_step(), and project() where no
/// tissue is within reach, may run concurrently with those of the blade.
class TubeContact {
  public:
    TubeContact(const Tube& tube, const Laryngoscope& scope, const RigidTransform& grip);

    /// Wakes tissue that the tube may touch while the grip moves from one pose to the other. Call before
    /// begin_step().
    void wake(pbd::SoftBody& body, const RigidTransform& grip_from, const RigidTransform& grip_to);
    /// Starts a step in which grip and blade move from one pose to the other.
    void begin_step(const pbd::Particles& particles, const RigidTransform& grip_from,
                    const RigidTransform& grip_to, const RigidTransform& blade_from,
                    const RigidTransform& blade_to);
    /// Whether tissue may be within reach in this step; if not, project() leaves particles unchanged.
    [[nodiscard]] bool reaches_tissue() const { return !near_.empty(); }
    /// Advances the rod by `dt` [s] under `gravity` [m/s^2], to the grip's pose at fraction `end` of the
    /// step.
    void predict(float dt, float end, const Vec3f& gravity);
    /// Solves rod and contacts for the substep that ends at fraction `end` of the step; moves the particles
    /// that the tube presses on.
    void project(pbd::Particles& particles, const Walls& walls, float begin, float end);
    void finish();

    /// Wrench of the tube on the hand, about the grip; mean over the step's substeps.
    [[nodiscard]] pbd::GripWrench grip_wrench() const;

    void reset(const RigidTransform& grip);
    /// Sets Young's modulus and curve.
    void set_material(const Tube& tube) { rod_.set_material(tube); }
    /// Centre line [segments + 1][m] from connector to tip.
    void nodes(std::vector<Vec3f>& out) const;
    [[nodiscard]] const pbd::Rod& rod() const { return rod_; }

  private:
    struct Ends {
        Vec3f rear = Vec3f::Zero(), front = Vec3f::Zero();  ///< [m]
    };
    /// Upper bounds of a segment's travel [m]: since its ends were found, and in this substep.
    struct SegmentTravel {
        float since_found = 0.0f, of_substep = 0.0f;
    };
    /// A particle that the tube may touch in this step, and the range of its segments. While the particle was
    /// at `at` [m], these were at least `clear` [m] away.
    struct Near {
        std::uint32_t particle = 0, first = 0, end = 0;
        Vec3f at = Vec3f::Zero();
        float clear = 0.0f;
    };

    void find_ends();
    /// Upper bound [m] of the tube's travel since find_ends().
    [[nodiscard]] float max_travel() const;
    /// Distance [m] from the tube's surface beyond which tissue cannot be touched in this step. Finds the
    /// ends.
    [[nodiscard]] float find_reach(const RigidTransform& grip_from, const RigidTransform& grip_to);
    /// Applies the last step's contact forces on particles at the start of this one: friction builds on them.
    void warm_start();
    /// Finds how far each segment may move before any of its sites could enter the shell.
    void find_clearance(const Walls& walls);
    void collide_shell(const Walls& walls);
    void collide_blade(const RigidTransform& before, const RigidTransform& now);
    void collide_tissue(const pbd::Particles& particles);
    void meet(const pbd::Particles& particles, Near& near, pbd::RodContact& contact) const;
    /// Finds the ends, and each segment's travel.
    void update_segment_travel();
    /// Where the tube runs head-on into a particle of `radius` [m], turns the contact normal to push the
    /// particle ahead (see pbd::runs_head_on()).
    void stop_head_on(const Vec3f& before, const Vec3f& now, float radius, pbd::RodContact& contact) const;
    /// Number of contact slots of the shell, and of the blade; those of the particles follow.
    [[nodiscard]] std::size_t sites() const { return rod_.size() * samples_per_segment; }

    static constexpr std::size_t samples_per_segment = 4;

    Laryngoscope scope_;
    pbd::Rod rod_;
    float dt_ = 0.0f;
    pbd::GripWrench grip_sum_;
    int grip_count_ = 0;
    RigidTransform grip_from_, grip_to_, blade_from_, blade_to_;
    std::vector<pbd::RodContact> contacts_;  ///< shell, blade (one per site each), particles
    std::vector<Ends> ends_, last_ends_;     ///< [segments]; current, and at the start of this step
    std::vector<Near> near_, last_near_;     ///< [particles in reach], sorted by particle index
    std::vector<Vec3f> last_force_;          ///< [near_][N]
    std::vector<SegmentTravel> travel_;      ///< [segments]
    std::vector<float> clearance_;           ///< [segments][m]
    bool near_blade_ = false;
};

}  // namespace eti::scene
