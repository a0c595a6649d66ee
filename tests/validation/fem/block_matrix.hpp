// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cstdint>
#include <vector>

namespace eti::fem {

/// A symmetric sparse matrix of 3 x 3 blocks, one per pair of joined vertices; the sparsity pattern is
/// computed once. Vertices held along all axes are left out.
class BlockMatrix {
  public:
    BlockMatrix() = default;
    /// `held`: by coordinate.
    BlockMatrix(std::size_t vertices, const std::vector<std::array<std::uint32_t, 2>>& pairs,
                std::vector<bool> held);

    void set_zero() { matrix_.coeffs().setZero(); }
    /// Adds to the block in the rows of `a` and the columns of `b`, which must be joined.
    void add(std::uint32_t a, std::uint32_t b, const Eigen::Matrix3d& block);
    /// Replaces rows and columns of held coordinates by those of the identity.
    void hold();
    /// Returns whether the matrix is positive definite; if so, solve() may be called.
    [[nodiscard]] bool factorise();
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }
    [[nodiscard]] const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

  private:
    [[nodiscard]] bool all_held(std::uint32_t vertex) const;

    std::vector<bool> held_;
    std::vector<std::uint32_t> first_, joined_;  // by vertex: its neighbours, in order
    Eigen::SparseMatrix<double> matrix_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
    bool analysed_ = false;
};

}  // namespace eti::fem
