// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/rod.hpp"
#include "server/pbd/soft_body.hpp"

namespace eti::scene {

/// The tube against shell, blade and soft tissue. All its contacts are solved together with the rod.
class TubeContact {
  public:
    TubeContact(const Tube& tube, const Laryngoscope& scope, const RigidTransform& grip);

    /// Wakes tissue that the tube may meet while the grip goes from one pose to the other. Before
    /// begin_step().
    void wake(pbd::SoftBody& body, const RigidTransform& grip_from, const RigidTransform& grip_to);
    /// Starts a step in which grip and blade go from one pose to the other.
    void begin_step(const pbd::Particles& particles, const RigidTransform& grip_from,
                    const RigidTransform& grip_to, const RigidTransform& blade_from,
                    const RigidTransform& blade_to);
    /// Whether tissue may come as near as to be met in this step; if none does, project() leaves particles
    /// alone.
    [[nodiscard]] bool meets_tissue() const { return !near_.empty(); }
    /// Moves the rod on by `dt` [s] under `gravity` [m/s^2], to the grip's pose at share `end` of the step.
    void predict(float dt, float end, const Vec3f& gravity);
    /// Solves rod and contacts for the substep that ends at share `end` of the step; moves the particles
    /// that the tube presses on.
    void project(pbd::Particles& particles, const DistanceGrid& shell, float begin, float end);
    void finish();

    /// What the tube exerts on the hand that holds it, about the grip; mean over the step's substeps.
    [[nodiscard]] pbd::GripWrench grip_wrench() const;

    void reset(const RigidTransform& grip);
    /// Takes another modulus and another curve.
    void set_material(const Tube& tube) { rod_.set_material(tube); }
    void nodes(std::vector<Vec3f>& out) const;
    [[nodiscard]] const pbd::Rod& rod() const { return rod_; }

  private:
    struct Ends {
        Vec3f rear = Vec3f::Zero(), front = Vec3f::Zero();  ///< [m]
    };
    /// How far a segment has come at most [m]: since its ends were found the last time, and in this substep.
    struct Way {
        float since_found = 0.0f, of_substep = 0.0f;
    };
    /// A particle that the tube may meet in this step, and with which of its segments. From where it was
    /// looked at, `at` [m], they have stayed `clear` [m] or more.
    struct Near {
        std::uint32_t particle = 0, first = 0, end = 0;
        Vec3f at = Vec3f::Zero();
        float clear = 0.0f;
    };

    void find_ends();
    /// [m], how far the tube has come since find_ends(), at most.
    [[nodiscard]] float farthest_from_ends() const;
    /// [m], from the tube's surface, that tissue has to be away not to be met in this step. Finds the ends.
    [[nodiscard]] float find_reach(const RigidTransform& grip_from, const RigidTransform& grip_to);
    /// What pressed on a particle in the last step does so as this one begins: friction builds on it.
    void keep_forces();
    /// Finds how far each segment may go before any site of it could come into the shell.
    void find_room(const DistanceGrid& shell);
    void meet_shell(const DistanceGrid& shell);
    void meet_blade(const RigidTransform& before, const RigidTransform& now);
    void meet_tissue(const pbd::Particles& particles);
    void meet(const pbd::Particles& particles, Near& near, pbd::RodContact& contact) const;
    /// Finds the ends, and how far each segment has come.
    void follow_ends();
    /// Where the tube runs head-on into a particle of `radius` [m], turns its contact to push that ahead
    /// (see pbd::runs_head_on).
    void stop_head_on(const Vec3f& before, const Vec3f& now, float radius, pbd::RodContact& contact) const;
    /// The contacts of shell and blade, and those of the particles after them.
    [[nodiscard]] std::size_t sites() const { return rod_.size() * samples_per_segment; }

    static constexpr std::size_t samples_per_segment = 4;

    Laryngoscope scope_;
    pbd::Rod rod_;
    float dt_ = 0.0f;
    pbd::GripWrench grip_sum_;
    int grip_count_ = 0;
    RigidTransform grip_from_, grip_to_, blade_from_, blade_to_;
    std::vector<pbd::RodContact> contacts_;  ///< shell, blade (one per site each), particles
    std::vector<Ends> ends_, last_ends_;     ///< of the segments; now, and as this step began
    std::vector<Near> near_, last_near_;     ///< by the particle's number
    std::vector<Vec3f> last_force_;          ///< [N], of those near now
    std::vector<Way> ways_;                  ///< of the segments
    std::vector<float> room_;                ///< [m], of the segments
    bool near_blade_ = false;
};

}  // namespace eti::scene
