// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "server/pbd/lanes.hpp"
#include "server/pbd/tetrahedra.hpp"

namespace eti::pbd {

/// How a mesh moves at large: the second level of a preconditioner, for what the blocks of single corners
/// hand on only to their neighbours in every iteration (the additive two-level method of Dryja & Widlund
/// 1987, overlapping subdomains here being corners). Motions are trilinear on a lattice many cells wide, laid
/// through the rest shape, so that their matrix is some dozens of numbers square and factorised in every
/// step. It is that of the shear, which is the same along every axis however the body turns, times what the
/// stiffest motion has besides. A preconditioner need not be exact; what overshoots would cost more than what
/// falls short.
class CoarseLevel {
  public:
    using Wide = std::vector<Eigen::Vector4f>;

    /// `rest` [m] by corner; corners that do not move (inverse mass 0 [1/kg]) stay where they are. `cell`
    /// [m]: width of the mesh's. `bulk_over_shear`: modulus lambda over mu. The stiffness is that of `mesh`
    /// now.
    void configure(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                   const Tetrahedra& mesh, float cell, float bulk_over_shear);
    /// The mesh's moduli are on the average this many times what they were then.
    void set_stiffness(float times) { stiffness_ = times; }

    /// Begins the matrix of a step with mass / dt^2, `per_mass` [1/s^2].
    void begin(float per_mass);
    /// Adds a spring [N/m] at a corner, or at a point between two that has these shares in them.
    void add_spring(std::uint32_t corner, float stiffness);
    void add_spring(const std::array<std::uint32_t, 2>& corners, const std::array<float, 2>& shares,
                    float stiffness);
    void factorise();

    /// By node; of the four numbers three.
    using Motion = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;
    [[nodiscard]] Motion none() const { return Motion::Zero(matrix_.rows(), 4); }
    /// Adds to the nodes' forces what `residual` [N] is at a corner.
    void restrict_to(Motion& force, std::size_t corner, const Four& residual) const {
        const Place& p = place_[corner];
        for (std::size_t n = 0; n < support; ++n) {
            float* const node = force.data() + std::size_t{4} * p.node[n];
            put(four(node) + p.weight[n] * residual, node);
        }
    }
    /// Finds how the nodes go by these forces, and returns the work [J]. Does not allocate.
    float solve(const Motion& force);
    /// [m], where a corner goes with the nodes.
    [[nodiscard]] Four way(std::size_t corner) const {
        const Place& p = place_[corner];
        Four sum{};
        for (std::size_t n = 0; n < support; ++n) {
            sum += p.weight[n] * four(motion_.data() + std::size_t{4} * p.node[n]);
        }
        return sum;
    }

    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(matrix_.rows()); }

  private:
    static constexpr std::size_t support = 8;
    /// The nodes about a corner, and their shares in its motion; none of one that does not move.
    struct Place {
        std::array<std::uint32_t, support> node{};
        std::array<float, support> weight{};
    };

    void number_nodes(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                      float width);
    void add_tetrahedra(const Tetrahedra& mesh, float times);
    /// Adds what a stiffness between two corners is between the nodes about them.
    void add_product(Eigen::MatrixXf& to, const Place& p, const Place& q, float times);

    std::vector<Place> place_;  // by corner
    Eigen::MatrixXf elastic_;   // [N/m], as configured
    Eigen::MatrixXf mass_;      // [kg]
    Eigen::MatrixXf matrix_;    // [N/m], of this step; only its lower half counts
    Eigen::LLT<Eigen::MatrixXf> factor_;
    Motion motion_;  // [m]
    float stiffness_ = 1.0f;
};

}  // namespace eti::pbd
