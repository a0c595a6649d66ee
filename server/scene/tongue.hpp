// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "server/pbd/implicit_tetrahedra.hpp"
#include "server/pbd/soft_body.hpp"
#include "server/scene/blade.hpp"
#include "server/scene/tongue_contacts.hpp"

namespace eti::scene {

/// The tongue as an implicit mesh among tissue that goes in substeps. A solve carries it through a part of a
/// step; in the substeps of that part its particles go there in a straight line. What pulls or pushes them
/// meanwhile (clusters, links, the tube, other tissue) meets the stiffness that a particle has alone, and is
/// a spring of that stiffness to the next solve: which is never stiffer than what pushes is held to be, so
/// that the exchange settles.
class Tongue {
  public:
    /// [m/s^2], beyond the weight that the unloaded shape already bears.
    Vec3f acceleration = Vec3f::Zero();

    /// The mesh has tissue's own mass; `particles` get the inverse masses that substeps of `substep` [s] see.
    /// Clusters have to be configured before, with a mesh that they do not move.
    void configure(const pbd::Tetrahedra::Description& mesh, std::vector<TongueContacts::Edge> surface,
                   pbd::Particles& particles, float substep);
    [[nodiscard]] bool empty() const { return mesh_.size() == 0; }
    /// By particle, whether the mesh moves it; empty where there is no mesh.
    [[nodiscard]] const std::vector<bool>& moved() const { return moved_; }
    [[nodiscard]] bool moves(std::size_t particle) const { return !moved_.empty() && moved_[particle]; }

    void set_rest(const pbd::Particles& particles) { mesh_.set_rest(particles); }
    void set_youngs_modulus(std::span<const float> moduli, pbd::Particles& particles);
    /// Forgets contacts; particles have to be at rest.
    void reset(pbd::Particles& particles);

    /// Into how many solves a step of `substeps` is cut in which the blade goes so far [m]; divides them.
    [[nodiscard]] static int solves_for(float blade_way, int substeps);

    /// Once before a step's solves: whether no tool is near any tissue. A while after the last has left, the
    /// tongue is drawn to rest for a moment: what has been wound about itself would stay so. Returns whether
    /// that begins, for which the tongue has to be awake.
    [[nodiscard]] bool note_tools(bool away);

    /// Solves for a part of a step of `dt` [s], in which `blade` goes from one pose to the other. Particles
    /// held by bone go the `fraction` of the remaining way to their rest position. The blade's impulses go to
    /// `felt`.
    void solve(pbd::SoftBody& body, const TongueContacts::MovingBlade& blade,
               const TongueContacts::Shell& shell, float dt, float fraction, BladeContact& felt);
    /// Puts the mesh's particles where they are after this share of the part.
    void place(pbd::Particles& particles, float share) const;
    /// Notes what the substep that ends at this share of the part has done to the mesh's particles, and puts
    /// them back on their way. Before place() of the next.
    void take_pushes(pbd::Particles& particles, float share);
    /// After the last substep: velocities, and what clusters want.
    void finish(pbd::SoftBody& body, int substeps);

  private:
    /// What substeps take a particle of the mesh to weigh: its own stiffness for one of them.
    void take_masses(pbd::Particles& particles) const;
    void gather_springs(const pbd::Particles& particles);

    pbd::ImplicitTetrahedra mesh_;
    TongueContacts contacts_;
    std::vector<bool> moved_;
    std::vector<pbd::ImplicitTetrahedra::Spring> pulls_;  // of clusters
    std::vector<Vec3f> from_, to_, push_;                 // by corner [m]
    float substep_ = 0.0f, dt_ = 0.0f;                    // [s]
    // Steps since the last tool left, in some of which the tongue is drawn.
    static constexpr int drawn_from = 18, drawn_until = 108;
    int away_ = drawn_until;
};

}  // namespace eti::scene
