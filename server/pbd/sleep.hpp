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
#include "server/pbd/shape_matching.hpp"

namespace eti::pbd {

/// What rests sleeps: tissue that nothing moves is not solved. Particles fall asleep and wake in groups: the
/// blocks of clusters, the tetrahedral mesh as a whole, and what only bone moves. A group reads more
/// particles than it moves: all members of its clusters, or of clusters that hold its mesh, and what
/// constraints tie to them. It falls asleep once none of these has gone farther than `still` for `steps`
/// steps, and wakes when one has gone farther than `shift` from where it was then, so that a slow drift is
/// not missed. A particle sleeps when all groups that move it do. What sleeps stays as the last solved
/// substep left it, also halfway through a substep (frames of clusters, ends of links), so that neighbours
/// awake are in balance with it. What a step decides hangs on the state after it alone: the bits do not
/// depend on threads.
class Sleep {
  public:
    struct Settings {
        float still =
            0.5e-6f;  ///< [m]; larger: more sleeps, and stops farther from where it would come to rest
        float shift = 2e-6f;  ///< [m]; larger: neighbours feel what moved so much later
        int steps = 9;        ///< of 1/180 s: half a period of 10 Hz, a hand's tremor
    };

    /// Begins with everything awake. `ties`: pairs of particles that read each other. `mesh`, by particle:
    /// those that a tetrahedral mesh moves, and clusters may move besides; empty: none.
    void configure(const Particles& particles, const ShapeMatching& shapes,
                   std::span<const Constraint::Pair> ties, const std::vector<bool>& mesh,
                   const Settings& settings);
    [[nodiscard]] bool on() const { return !asleep_.empty(); }

    /// Posture, moduli, gravity or walls are others now.
    void wake_whole(Particles& particles);
    /// Wakes the groups that move `particle`.
    void wake(Particles& particles, std::uint32_t particle);
    /// Wakes groups of which a free particle lies in `box` and is near a tool:
    /// near(position [m], radius [m]) -> bool.
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
    /// Whether a particle has gone farther than `still` in the last `steps` steps.
    [[nodiscard]] bool stirs(std::uint32_t particle) const {
        return on() && age_[particle] < settings_.steps;
    }

    /// Once before a step's substeps: lists the particles that are awake. Returns whether others are than
    /// before.
    [[nodiscard]] bool arrange(Particles& particles);
    /// Once after a step: who falls asleep, and who wakes because of neighbours.
    void end_step(Particles& particles);

    [[nodiscard]] bool whole_awake() const { return sleeping_ == 0; }
    /// Groups that move anything.
    [[nodiscard]] std::size_t groups() const { return groups_; }
    [[nodiscard]] std::size_t awake_groups() const { return groups_ - sleeping_; }
    /// Whether anything may move; where nothing ever sleeps there are no groups, and all is awake.
    [[nodiscard]] bool any_awake() const { return !on() || sleeping_ < groups_; }
    [[nodiscard]] bool mesh_awake() const { return !on() || asleep_[mesh()] == 0; }
    [[nodiscard]] bool held_awake() const { return !on() || asleep_[held()] == 0; }
    [[nodiscard]] bool block_awake(std::size_t block) const { return !on() || asleep_[block] == 0; }
    /// By block of clusters, where sleep is on.
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
    void count_stillness(const Particles& particles);
    [[nodiscard]] bool is_still(std::uint32_t group);

    Settings settings_;
    std::vector<std::uint8_t> asleep_;               // by group: blocks, mesh, held by bone
    std::vector<std::uint32_t> first_move_, moves_;  // particles by group
    std::vector<std::uint32_t> first_read_, reads_;  // the same; a place in reads_ is a slot
    std::vector<std::uint32_t> first_slot_, slots_;  // slots by particle
    std::vector<std::uint32_t> group_of_slot_;
    std::vector<std::uint32_t> first_mover_, movers_;  // groups that move a particle, by particle
    std::vector<std::uint16_t> awake_movers_;          // of these the number that are awake
    std::vector<Vec3f> slept_at_;                      // [m], by slot
    std::vector<Eigen::AlignedBox3f> box_;             // by group, of the particles that it moves
    std::vector<std::uint8_t> group_age_;              // steps since it woke
    std::vector<std::uint32_t> last_stirring_;         // slot by group: where to look first
    std::vector<Vec3f> still_at_;                      // [m], by particle, where counting began
    std::vector<std::uint8_t> age_;                    // steps since
    std::vector<std::uint32_t> watched_;               // slots of sleeping groups whose particles are awake
    std::size_t groups_ = 0, sleeping_ = 0;            // that move anything; and of these
    bool changed_ = false, restart_ = true;
};

}  // namespace eti::pbd
