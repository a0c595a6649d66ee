// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "server/pbd/contact/mesh_contact.hpp"
#include "server/pbd/particles.hpp"
#include "server/scene/shell_clearance.hpp"

namespace eti::scene {

/// Contacts of an implicit mesh's surface with the laryngoscope's capsules, and of its particles with the
/// offset shell, with their forces of the previous step. The blade collides with balls about particles and
/// at the Gauss points of triangles, which push no particle alone. Not thread safe.
class TongueContacts {
  public:
    /// A blade that moves from one pose to the other within a step.
    struct MovingBlade {
        const Laryngoscope& scope;
        RigidTransform from, to;
    };

    using Triangle = std::array<std::uint32_t, 3>;  ///< particle indices

    /// The surface that the blade meets.
    struct Surface {
        std::vector<std::uint32_t> particles;
        std::vector<Triangle> triangles;
    };

    /// `movers`, ascending: particles that the mesh moves; at least one corner of each triangle moves.
    void configure(std::vector<std::uint32_t> movers, Surface surface);
    void reset();

    /// Finds the contacts at the predicted positions, and those of the last call. `contacts` holds the last
    /// call's contacts and receives the new ones, in an order that depends only on which pairs touch.
    void find(const pbd::Particles& particles, const MovingBlade& blade, const Walls& walls,
              std::vector<pbd::MeshContact>& contacts);

    /// Expected upper bound of simultaneous contacts, for reserving memory so that a step does not allocate;
    /// not a hard limit.
    [[nodiscard]] std::size_t expected_count() const {
        return movers_.size() + surface_.particles.size() + 3 * surface_.triangles.size();
    }
    /// Whether contact `number` is with the blade.
    [[nodiscard]] bool is_with_blade(std::size_t number) const {
        return (key_[number] & 0xff) < shell_obstacle;
    }

  private:
    static constexpr std::uint8_t shell_obstacle = 3;  // lower values: capsule index

    void collide_blade(const pbd::Particles& particles, const MovingBlade& blade);
    void collide_shell(const pbd::Particles& particles, const Walls& walls);
    struct PreviousContact {
        std::uint64_t key;
        Vec3f force, slip;
    };
    /// The contact's state in the last step; nullptr for a new contact.
    [[nodiscard]] const PreviousContact* find_previous(std::uint64_t key) const;
    /// Adds a contact of a feature (numbered over movers, then the surface) that touches now or did in the
    /// last step; its `slip` is that of this step so far.
    void add(const pbd::MeshContact& contact, std::size_t feature, std::uint8_t obstacle);

    std::vector<std::uint32_t> movers_;  // particle indices, ascending
    Surface surface_;
    ShellClearance clearance_;           // [movers]
    std::vector<PreviousContact> last_;  // [contacts of the last call], sorted by key
    std::vector<pbd::MeshContact> now_;  // [contacts]
    std::vector<std::uint64_t> key_;     // [contacts]: feature and obstacle
};

}  // namespace eti::scene
