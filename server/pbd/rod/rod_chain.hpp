// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Cholesky>

#include <span>
#include <vector>

#include "server/pbd/rod/rod_joint.hpp"

namespace eti::pbd {

/// Direct solver for a symmetric positive definite block-tridiagonal system of 6 x 6 blocks (block Cholesky
/// from rear to front): solves the chain at once, whatever its stiffness.
class RodChain {
  public:
    /// Initializes factors to identity: Eigen leaves parts of an empty factorization uninitialized, and a rod
    /// may be copied before its first step.
    explicit RodChain(std::size_t blocks)
        : pivot_(blocks), link_(blocks), factor_(blocks, Eigen::LLT<Mat6d>(Mat6d(Mat6d::Identity()))) {}

    [[nodiscard]] std::size_t size() const { return pivot_.size(); }

    /// Diagonal block `i` and the block to its right (row i, column i + 1); fill both before factorize().
    Mat6d& diagonal(std::size_t i) { return pivot_[i]; }
    Mat6d& right(std::size_t i) { return link_[i]; }

    void factorize();

    /// Replaces the right-hand side by the solution. Requires factorize().
    void solve(std::span<Vec6d> rhs) const;

    /// The same for a right-hand side that is zero before block `first`.
    void solve_from(std::size_t first, std::span<Vec6d> rhs) const;

  private:
    std::vector<Mat6d> pivot_;  ///< Schur complements once factorized
    std::vector<Mat6d> link_;
    std::vector<Eigen::LLT<Mat6d>> factor_;
};

}  // namespace eti::pbd
