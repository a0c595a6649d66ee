// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools.hpp"
#include "server/pbd/mesh_contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/scene/shell_clearance.hpp"

namespace eti::scene {

/// Which particles and surface edges of an implicit mesh touch the laryngoscope's capsules or the offset
/// shell, and with what force they did in the step before. The blade meets the particles' balls, and between
/// them what a ball covers that runs along an edge of the surface.
class TongueContacts {
  public:
    using Edge = std::array<std::uint32_t, 2>;  ///< particles

    /// A blade that goes from one pose to the other within a step.
    struct MovingBlade {
        const Laryngoscope& scope;
        RigidTransform from, to;
    };

    /// `revision` changes with the distances.
    struct Shell {
        const DistanceGrid& distance;
        std::uint64_t revision;
    };

    /// `movers`, ascending: particles that the mesh moves; `edges`: those of its surface whose ends both
    /// move.
    void configure(std::vector<std::uint32_t> movers, std::vector<Edge> edges);
    void reset();

    /// What touches at the predicted positions, or did so last time. `contacts` are those of the last time,
    /// and become those of now, in an order that hangs on nothing but who touches what.
    void find(const pbd::Particles& particles, const MovingBlade& blade, const Shell& shell,
              std::vector<pbd::MeshContact>& contacts);

    /// As many as will touch at once, so that room for them keeps a step from allocating; more may come.
    [[nodiscard]] std::size_t most() const { return 2 * movers_.size() + edges_.size(); }
    /// Whether contact `number` is with the blade.
    [[nodiscard]] bool is_blades(std::size_t number) const { return obstacle_[number] < shell_obstacle; }

  private:
    static constexpr std::uint8_t shell_obstacle = 3;  // below: a capsule's number

    void meet_blade(const pbd::Particles& particles, const MovingBlade& blade);
    void meet_shell(const pbd::Particles& particles, const Shell& shell);
    struct Known {
        std::uint64_t key;
        Vec3f force, slip;
    };
    /// What is known of this contact from the last step; nullptr for one that is new.
    [[nodiscard]] const Known* known(const pbd::MeshContact& contact, std::uint8_t obstacle) const;
    /// Takes it up where it touches, or did in the last step; `slip` in it is that of this step so far.
    void add(const pbd::MeshContact& contact, std::uint8_t obstacle);

    std::vector<std::uint32_t> movers_;
    std::vector<Edge> edges_;
    ShellClearance clearance_;  // of the movers
    std::vector<Known> last_;   // sorted
    std::vector<pbd::MeshContact> now_;
    std::vector<std::uint8_t> obstacle_;
};

}  // namespace eti::scene
