// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/model/tools/tools.hpp"
#include "server/pbd/contact/mesh_contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/scene/shell_clearance.hpp"

namespace eti::scene {

/// Contacts of an implicit mesh's particles and surface edges with the laryngoscope's capsules or the offset
/// shell, with their forces of the previous step. The blade collides with the particles' balls, and between
/// them with a ball swept along each surface edge. Not thread safe.
class TongueContacts {
  public:
    using Edge = std::array<std::uint32_t, 2>;  ///< particle indices

    /// A blade that moves from one pose to the other within a step.
    struct MovingBlade {
        const Laryngoscope& scope;
        RigidTransform from, to;
    };

    /// `revision` changes whenever the distances do.
    struct Shell {
        const DistanceGrid& distance;
        std::uint64_t revision;
    };

    /// `movers`, ascending: particles that the mesh moves; `edges`: surface edges whose ends both move.
    void configure(std::vector<std::uint32_t> movers, std::vector<Edge> edges);
    void reset();

    /// Finds the contacts at the predicted positions, and those of the last call. `contacts` holds the last
    /// call's contacts and receives the new ones, in an order that depends only on which pairs touch.
    void find(const pbd::Particles& particles, const MovingBlade& blade, const Shell& shell,
              std::vector<pbd::MeshContact>& contacts);

    /// Expected upper bound of simultaneous contacts, for reserving memory so that a step does not allocate;
    /// not a hard limit.
    [[nodiscard]] std::size_t expected_count() const { return 2 * movers_.size() + edges_.size(); }
    /// Whether contact `number` is with the blade.
    [[nodiscard]] bool is_with_blade(std::size_t number) const { return obstacle_[number] < shell_obstacle; }

  private:
    static constexpr std::uint8_t shell_obstacle = 3;  // lower values: capsule index

    void collide_blade(const pbd::Particles& particles, const MovingBlade& blade);
    void collide_shell(const pbd::Particles& particles, const Shell& shell);
    struct PreviousContact {
        std::uint64_t key;
        Vec3f force, slip;
    };
    /// The contact's state in the last step; nullptr for a new contact.
    [[nodiscard]] const PreviousContact* find_previous(const pbd::MeshContact& contact,
                                                       std::uint8_t obstacle) const;
    /// Adds a contact that touches now or did in the last step; its `slip` is that of this step so far.
    void add(const pbd::MeshContact& contact, std::uint8_t obstacle);

    std::vector<std::uint32_t> movers_;  // particle indices, ascending
    std::vector<Edge> edges_;
    ShellClearance clearance_;            // [movers]
    std::vector<PreviousContact> last_;   // [contacts of the last call], sorted by key
    std::vector<pbd::MeshContact> now_;   // [contacts]
    std::vector<std::uint8_t> obstacle_;  // [contacts]: capsule index, or shell_obstacle
};

}  // namespace eti::scene
