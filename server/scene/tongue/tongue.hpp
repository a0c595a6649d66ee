// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/blade.hpp"
#include "server/scene/tongue/self_contact_finder.hpp"
#include "server/scene/tongue/tongue_contacts.hpp"

namespace eti::scene {

/// The tongue as an implicit mesh among tissue that is solved in substeps.
///
/// A solve carries the mesh through a part of a step; during the substeps of that part its particles move in
/// straight lines. Clusters, links, tube and other tissue that push particles meanwhile meet the stiffness of
/// a single particle, and enter the next solve as springs of that stiffness. These are never stiffer than
/// what pushes is assumed to be, so that the exchange converges.
///
/// Not thread safe: the physics thread calls all functions.
class Tongue {
  public:
    /// [m/s^2], in addition to the weight that the unloaded shape already carries.
    Vec3f acceleration = Vec3f::Zero();

    /// The mesh has the tissue's physical mass; `particles` receive the inverse masses for substeps of
    /// `substep` [s]. Configure clusters before, with a mesh that they do not move.
    /// Of the `surface`, what does not move is left out.
    void configure(const pbd::ImplicitMesh::Description& mesh, TongueContacts::Surface surface,
                   pbd::Particles& particles, float substep);
    /// From now on the mesh stays out of itself, and other particles of it out of the solid.
    void keep_apart(const SelfContactFinder::Description& description);
    /// From now on its stress relaxes.
    void relax(const pbd::Relaxation& relaxation) { mesh_.relax(relaxation); }
    [[nodiscard]] bool empty() const { return mesh_.size() == 0; }
    /// [particles]: whether the mesh moves it; empty where there is no mesh.
    [[nodiscard]] const std::vector<bool>& moved() const { return moved_; }
    [[nodiscard]] bool moves(std::size_t particle) const { return !moved_.empty() && moved_[particle]; }

    [[nodiscard]] const pbd::ImplicitMesh& mesh() const { return mesh_; }
    /// A particle that the mesh moves.
    [[nodiscard]] std::uint32_t any_moved() const {
        return static_cast<std::uint32_t>(std::ranges::find(moved_, true) - moved_.begin());
    }
    /// Bones that hold the mesh and yield.
    [[nodiscard]] pbd::YieldingBodies& bodies() { return mesh_.bodies; }
    /// Calls body(particle, force) with each force [N] of the mesh on tissue outside of it: of the last
    /// solve's springs, and of links.
    template <class Body>
    void for_attachments(const pbd::Particles& particles, const Body& body) const {
        for (const pbd::ImplicitMesh::Spring& spring : mesh_.springs) {
            if (spring.attachment) {
                body(spring.particle,
                     Vec3f(spring.stiffness * (particles.position[spring.particle] - spring.to)));
            }
        }
        mesh_.for_outer_ends(particles, body);
    }
    /// Calls body(contact) for the contacts with the shell that find_contacts() has found.
    template <class Body>
    void for_wall_contacts(const Body& body) {
        for (std::size_t n = 0; n < mesh_.contacts.size(); ++n) {
            if (!contacts_.is_with_blade(n)) {
                body(mesh_.contacts[n]);
            }
        }
    }

    /// Adopts `particles.rest`. What holds the mesh from outside moves along with the rest shape.
    void set_rest(const pbd::Particles& particles);
    /// [tetrahedra][Pa] and [hexahedra][Pa]
    void set_youngs_modulus(std::span<const float> tetrahedra, std::span<const float> hexahedra,
                            pbd::Particles& particles);
    /// [links of the mesh][N/m]
    void set_link_stiffness(std::span<const float> stiffness) { mesh_.set_link_stiffness(stiffness); }
    /// Discards contacts and memory of deformations; particles must be at rest.
    void reset(pbd::Particles& particles);

    /// Number of solves for a step of `substeps` in which the blade travels `blade_way` [m]; divides
    /// `substeps`.
    [[nodiscard]] static int solve_count(float blade_way, int substeps);

    /// Call once before a step's solves, with whether no tool is near any tissue. Some time after the last
    /// tool has left, the tongue is drawn to its rest shape for a moment, because a mesh wound about itself
    /// or behind a wall would stay so; contacts and its stress relaxation are forgotten meanwhile. Returns
    /// true when that begins; the tongue must then be awake.
    [[nodiscard]] bool update_tools_away(bool away);
    /// Whether it is being drawn to its rest shape.
    [[nodiscard]] bool is_drawn() const { return away_ > relax_begin && away_ < relax_end; }

    /// Begins to solve for a part of a step of `dt` [s], in which `blade` moves from one pose to the other:
    /// finds contacts. Particles bound to bone move by `fraction` of the remaining distance to their rest
    /// position.
    void find_contacts(pbd::SoftBody& body, const TongueContacts::MovingBlade& blade, const Walls& walls,
                       float dt, float fraction);
    /// Solves for that part. Impulses of the blade, then at this pose, are added to `blade_contact`.
    void solve(pbd::SoftBody& body, const RigidTransform& blade, BladeContact& blade_contact);
    /// Places the mesh's particles where they are at this fraction of the part.
    void place(pbd::Particles& particles, float share) const;
    /// Records the displacements that the substep ending at this fraction of the part applied to the mesh's
    /// particles, and undoes them. Call before the next place().
    void absorb_contact_displacements(pbd::Particles& particles, float share);
    /// Call after the last substep: sets velocities and the springs of clusters.
    void finish(pbd::SoftBody& body, int substeps);

  private:
    /// Sets the masses that substeps see: a particle's own stiffness over one substep.
    void set_substep_masses(pbd::Particles& particles) const;
    void gather_springs(const pbd::Particles& particles);
    void forget_contacts();

    pbd::ImplicitMesh mesh_;
    TongueContacts contacts_;
    SelfContactFinder self_contacts_;
    std::vector<bool> moved_;                                 // [particles]
    std::vector<pbd::ImplicitMesh::Spring> cluster_springs_;  // from clusters
    std::vector<Vec3f> from_, to_;                            // [corners][m]
    std::vector<Vec3f> push_;  // [corners][m], from a corner to the end of the spring of what pushes it
    float substep_ = 0.0f, dt_ = 0.0f;  // [s]
    // Steps since the last tool left, between which the tongue is drawn to rest.
    static constexpr int relax_begin = 18, relax_end = 108;
    int away_ = relax_end;
};

}  // namespace eti::scene
