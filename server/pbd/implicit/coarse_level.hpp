// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "server/pbd/contact/mesh_contact.hpp"
#include "server/pbd/implicit/hexahedra.hpp"
#include "server/pbd/implicit/tetrahedra.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// Coarse level of a two-level preconditioner, for low-frequency motions, which blocks of single corners
/// propagate by only one neighbour per iteration (additive two-level method of Dryja & Widlund 1987;
/// overlapping subdomains here are corners).
///
/// Motions are trilinear on a lattice of wide cells laid through the rest shape, so that the matrix has some
/// dozens of rows and is factorised every step. It is the matrix of shear, which is isotropic under rotations
/// of the body, scaled to the stiffest motion. A preconditioner need not be exact; overshooting would cost
/// more than undershooting.
class CoarseLevel {
  public:
    using Wide = std::vector<Eigen::Vector4f>;

    /// `rest` [corners][m]; corners with inverse mass 0 [1/kg] stay fixed. `cell` [m]: width of the mesh's
    /// cells. `bulk_over_shear`: lambda over mu. Uses the current stiffness of the elements.
    void configure(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                   const Tetrahedra& tetrahedra, const Hexahedra& hexahedra, float cell,
                   float bulk_over_shear);
    /// Sets the mean ratio of the mesh's moduli to those at configure().
    void set_stiffness(float times) { stiffness_ = times; }

    /// Starts a step's matrix with mass / dt^2, `per_mass` [1/s^2].
    void begin(float per_mass);
    /// Adds a spring [N/m] at a corner, or at a point between corners with these weights.
    void add_spring(std::uint32_t corner, float stiffness);
    void add_spring(std::span<const std::uint32_t> corners, std::span<const float> shares, float stiffness);
    void factorise();

    /// [nodes]; three of the four numbers are used.
    using Motion = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
    [[nodiscard]] Motion zero_motion() const { return Motion::Zero(matrix_.rows(), 4); }
    /// Restriction: adds the `residual` [N] of a corner to the nodes' forces.
    void restrict_to(Motion& force, std::size_t corner, const Float4& residual) const {
        const Place& p = place_[corner];
        for (std::size_t n = 0; n < support; ++n) {
            float* const node = force.data() + std::size_t{4} * p.node[n];
            put(load_float4(node) + p.weight[n] * residual, node);
        }
    }
    /// Solves for the nodes' motion under these forces, and returns the work [J]. Does not allocate.
    float solve(const Motion& force);
    /// Prolongation [m]: a corner's motion with the nodes.
    [[nodiscard]] Float4 displacement(std::size_t corner) const {
        const Place& p = place_[corner];
        Float4 sum{};
        for (std::size_t n = 0; n < support; ++n) {
            sum += p.weight[n] * load_float4(motion_.data() + std::size_t{4} * p.node[n]);
        }
        return sum;
    }

    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(matrix_.rows()); }

  private:
    static constexpr std::size_t support = 8;
    static constexpr std::size_t max_joined = support * MeshContact::max_corners;
    /// Nodes around a corner and their weights; all zero for a fixed corner.
    struct Place {
        std::array<std::uint32_t, support> node{};
        std::array<float, support> weight{};
    };

    void number_nodes(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                      float width);
    void add_tetrahedra(const Tetrahedra& tetrahedra, float times);
    void add_hexahedra(const Hexahedra& hexahedra, float times);
    /// As add_spring(), with the corners' nodes joined first.
    void add_joined(std::span<const std::uint32_t> corners, std::span<const float> shares, float stiffness);
    /// Adds a stiffness between two corners, projected to their nodes.
    void add_product(Eigen::MatrixXf& to, const Place& p, const Place& q, float times);

    std::vector<Place> place_;  // [corners]
    Eigen::MatrixXf elastic_;   // [N/m], as configured
    Eigen::MatrixXf mass_;      // [kg]
    Eigen::MatrixXf matrix_;    // [N/m], of this step; lower half only
    Eigen::LLT<Eigen::MatrixXf> factor_;
    Motion motion_;  // [m]
    float stiffness_ = 1.0f;
};

}  // namespace eti::pbd
