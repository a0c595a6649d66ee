// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/constraint.hpp"
#include "server/pbd/particles.hpp"
#include "server/pbd/soft/shape_matching.hpp"

namespace eti::pbd {

/// Sleeping: tissue at rest is not solved.
///
/// Particles fall asleep and wake in groups: the blocks of clusters, the tetrahedral mesh as a whole, and the
/// particles that only bone moves. A group reads more particles than it moves: all members of its clusters,
/// or of clusters that contain its mesh, and particles coupled to them by constraints. It falls asleep once
/// none of these has moved farther than `still` for `steps` steps. It wakes when one has moved farther than
/// `shift` from its position then, so that slow drift is not missed. A particle sleeps when all groups that
/// move it sleep.
///
/// Sleeping state stays as the last solved substep left it, including intermediate results (frames of
/// clusters, ends of links), so that awake neighbours are in balance with it. Decisions depend only on the
/// state after a step: results do not depend on threads.
class Sleep {
  public:
    struct Settings {
        float still =
            0.5e-6f;          ///< [m]; larger: more tissue sleeps, and it stops farther from its equilibrium
        float shift = 2e-6f;  ///< [m]; larger: neighbours react correspondingly later
        int steps = 9;        ///< steps of 1/180 s: half a period of 10 Hz, a hand's tremor
    };

    /// Starts with everything awake. `coupled_pairs`: pairs of particles that read each other. `mesh`
    /// [particles]: those that a tetrahedral mesh moves, possibly along with clusters; empty: none.
    void configure(const Particles& particles, const ShapeMatching& shapes,
                   std::span<const Constraint::Pair> coupled_pairs, const std::vector<bool>& mesh,
                   const Settings& settings);
    [[nodiscard]] bool enabled() const { return !asleep_.empty(); }

    /// Wakes everything: after a change of posture, moduli, gravity or walls.
    void wake_all(Particles& particles);
    /// Wakes the groups that move `particle`.
    void wake(Particles& particles, std::uint32_t particle);
    /// Wakes groups with a free particle in `box` that is near a tool: near(position [m], radius [m]) ->
    /// bool.
    template <class Near>
    void wake_near(Particles& particles, const Eigen::AlignedBox3f& box, const Near& near) {
        for (std::uint32_t g = 0; sleeping_ > 0 && g < asleep_.size(); ++g) {
            if (asleep_[g] != 0 && g != held() && box.intersects(box_[g])) {
                for (const std::uint32_t i : moves(g)) {
                    if (box.contains(particles.position[i]) &&
                        near(particles.position[i], particles.radius[i])) {
                        wake_group(particles, g);
                        break;
                    }
                }
            }
        }
    }
    /// While true, the mesh does not fall asleep, although it is still: it creeps.
    void keep_mesh_awake(bool awake) { mesh_creeps_ = awake; }
    /// Whether a particle has moved farther than `still` in the last `steps` steps.
    [[nodiscard]] bool is_moving(std::uint32_t particle) const {
        return enabled() && age_[particle] < settings_.steps;
    }

    /// Call once before a step's substeps: lists the awake particles. Returns whether the list has changed.
    [[nodiscard]] bool update_awake(Particles& particles);
    /// Call once after a step: puts groups to sleep, and wakes those with moving neighbours.
    void end_step(Particles& particles);

    [[nodiscard]] bool all_awake() const { return sleeping_ == 0; }
    /// Number of groups that move any particle.
    [[nodiscard]] std::size_t groups() const { return groups_; }
    [[nodiscard]] std::size_t awake_groups() const { return groups_ - sleeping_; }
    /// Whether any particle may move; without sleeping there are no groups and all are awake.
    [[nodiscard]] bool any_awake() const { return !enabled() || sleeping_ < groups_; }
    [[nodiscard]] bool mesh_awake() const { return !enabled() || asleep_[mesh()] == 0; }
    [[nodiscard]] bool held_awake() const { return !enabled() || asleep_[held()] == 0; }
    [[nodiscard]] bool block_awake(std::size_t block) const { return !enabled() || asleep_[block] == 0; }
    /// [blocks of clusters]; requires sleeping to be enabled.
    [[nodiscard]] std::span<const std::uint8_t> blocks_asleep() const {
        return std::span(asleep_).first(mesh());
    }

  private:
    using Indices = std::span<const std::uint32_t>;
    [[nodiscard]] std::size_t mesh() const { return asleep_.size() - 2; }
    [[nodiscard]] std::size_t held() const { return asleep_.size() - 1; }
    [[nodiscard]] Indices moves(std::size_t group) const {
        return {moves_.data() + first_move_[group], moves_.data() + first_move_[group + 1]};
    }
    void wake_group(Particles& particles, std::uint32_t group);
    void put_to_sleep(Particles& particles, std::uint32_t group);
    void update_rest_counters(const Particles& particles);
    [[nodiscard]] bool is_still(std::uint32_t group);

    Settings settings_;
    std::vector<std::uint8_t> asleep_;                 // [groups]: blocks, mesh, held by bone
    std::vector<std::uint32_t> first_move_, moves_;    // [groups + 1], particles moved by each
    std::vector<std::uint32_t> first_read_, reads_;    // [groups + 1], particles read by each; an index into
                                                       // reads_ is a slot
    std::vector<std::uint32_t> first_slot_, slots_;    // [particles + 1], slots of each
    std::vector<std::uint32_t> group_of_slot_;         // [slots]
    std::vector<std::uint32_t> first_mover_, movers_;  // [particles + 1], groups that move each
    std::vector<std::uint16_t> awake_movers_;          // [particles], number of these that are awake
    std::vector<Vec3f> slept_at_;                      // [slots][m]
    std::vector<Eigen::AlignedBox3f> box_;             // [groups], of the particles that it moves
    std::vector<std::uint8_t> group_age_;              // [groups], steps since it woke
    std::vector<std::uint32_t> last_moving_slot_;      // [groups], slot to test first
    std::vector<Vec3f> still_at_;                      // [particles][m], position when counting began
    std::vector<std::uint8_t> age_;                    // [particles], steps since
    std::vector<std::uint32_t> watched_;               // slots of sleeping groups with awake particles
    std::size_t groups_ = 0, sleeping_ = 0;            // groups that move particles, and how many of them
                                                       // sleep
    bool changed_ = false, restart_ = true, mesh_creeps_ = false;
};

}  // namespace eti::pbd
