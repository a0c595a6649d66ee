// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/pbd/contact/mesh_contact.hpp"
#include "server/pbd/particles.hpp"

namespace eti::scene {

/// Contacts that keep a deforming solid's surface, and that of its neighbours, out of the solid itself.
///
/// A point within a tetrahedron of the solid has, by its barycentric coordinates, a place X in the unloaded
/// shape. The signed distance there says how deep it lies and which way out is shortest, whatever the
/// deformation, so that a contact never loses its side (McAdams et al. 2011, "Efficient elasticity for
/// character skinning with contact and collisions", section 5; here with multipliers). The way out is carried
/// to the deformed shape by the corners' mean cofactors of the deformation gradient, as areas are.
///
/// Not modelled: friction; a point within two folds at once touches one of them.
class SelfContactFinder {
  public:
    struct Description {
        std::vector<std::array<std::uint32_t, 4>> solid;  ///< tetrahedra
        std::vector<Vec3f> rest;                          ///< [particles][m], unloaded and unposed
        /// [particles]: part of the solid's free surface. What lies beyond the rest of its surface, where it
        /// is attached, counts as inside, so that nothing is pushed out there.
        std::vector<bool> free;
        std::vector<std::uint32_t> neighbours;  ///< points of other tissue that must stay out, too
    };
    void configure(const Description& description);
    void reset();

    /// Finds the contacts at the predicted positions. `contacts` holds the last call's after their step.
    void find(const pbd::Particles& particles, std::vector<pbd::MeshContact>& contacts);

    [[nodiscard]] std::size_t points() const { return points_.size(); }

  private:
    struct Element {
        std::array<std::uint32_t, 4> corner;
        Vec3f origin, centre;  // [m], at rest
        Eigen::Matrix3f edges;
        float inverse_determinant;
        float radius;  // [m] at rest, from the centre to the farthest corner
    };
    struct Point {
        std::uint32_t particle;
        Vec3f rest;
        bool own;  // of the solid's surface
    };
    /// The last contact of a point.
    struct Memory {
        Vec3f place = Vec3f::Zero();  // [m], at rest
        pbd::MeshContact contact;
        bool known = false;
    };
    struct Hit {
        float score = 0.0f;
        std::uint32_t element = 0;
        Vec3f share = Vec3f::Zero();  // of the last three corners
        Vec3f place = Vec3f::Zero();
        Vec3f way_out = Vec3f::Zero();  // deformed gradient of the distance
        float depth = 0.0f;             // [m], at rest
        bool found = false;
    };

    void build_distance(const Description& description);
    void collect_pairs(const pbd::Particles& particles);
    [[nodiscard]] bool stale(const pbd::Particles& particles) const;
    void test_pairs(const pbd::Particles& particles);
    /// Mean of the cofactors of a corner's elements.
    [[nodiscard]] const Eigen::Matrix3f& cofactor_at(std::uint32_t particle, const pbd::Particles& particles);

    std::vector<Element> elements_;
    std::vector<Point> points_;
    DistanceGrid distance_;            // [m], of the unloaded shape to its free surface
    std::vector<std::uint32_t> used_;  // particles of elements and points
    std::vector<std::uint32_t> first_element_, elements_of_;  // [particles + 1]: of each corner
    std::vector<Vec3f> seen_;                                 // [used_][m], when pairs were collected
    std::vector<std::array<std::uint32_t, 2>> pairs_;         // element, point; by element
    std::vector<std::uint32_t> cell_, cell_start_, in_cell_;
    std::vector<Vec3f> at_in_cell_;                // [points][m], in the order of in_cell_
    std::vector<Hit> hits_;                        // [points]
    std::vector<Memory> memory_;                   // [points]
    std::vector<std::uint32_t> point_of_contact_;  // [contacts of the last call]: point
    std::vector<Eigen::Matrix3f> cofactor_;        // [particles]
    std::vector<std::uint32_t> cofactor_call_;
    std::uint32_t call_ = 0;
};

}  // namespace eti::scene
