// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>

#include "server/pbd/contact/surface_edges.hpp"
#include "server/scene/tongue/tongue_contacts.hpp"
#include "tests/bench/server/accuracy/block_body.hpp"

namespace eti::bench {

/// A capsule against a block of an implicit method, with the contact search of the scene's tongue.
class SceneContact {
  public:
    /// `capsule`: at the identity pose. Hold particles of the body before.
    SceneContact(BlockBody& body, const Capsule& capsule) {
        scope_.capsules.fill({Vec3f::Constant(10.0f), Vec3f::Constant(10.0f), 0.0f});  // far away
        scope_.capsules.back() = capsule;
        const pbd::Particles& p = body.particles();
        const auto moves = [&](std::uint32_t i) { return p.inverse_mass[i] > 0.0f; };
        std::vector<std::uint32_t> movers;
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            if (moves(i)) {
                movers.push_back(i);
            }
        }
        std::vector<scene::TongueContacts::Triangle> triangles =
            pbd::surface_triangles(body.lattice().tetrahedra);
        std::erase_if(triangles, [&](const auto& corners) { return std::ranges::none_of(corners, moves); });
        contacts_.configure(movers, {.particles = {}, .triangles = std::move(triangles)});
        nothing_.size = {2, 2, 2};
        nothing_.value.assign(8, 1.0f);
    }

    void find(pbd::ImplicitMesh& mesh, const pbd::Particles& p, const RigidTransform& from,
              const RigidTransform& to) {
        contacts_.find(p, {scope_, from, to}, {nothing_, 1}, mesh.contacts);
    }

    /// [N], of the tissue on the capsule, upwards.
    [[nodiscard]] static double reaction(const pbd::ImplicitMesh& mesh) {
        double sum = 0.0;
        for (const pbd::MeshContact& c : mesh.contacts) {
            sum -= static_cast<double>(c.force.z());
        }
        return std::isfinite(sum) ? sum : 0.0;
    }

  private:
    Laryngoscope scope_;
    DistanceGrid nothing_;
    scene::TongueContacts contacts_;
};

}  // namespace eti::bench
