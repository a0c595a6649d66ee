// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod_chain.hpp"

namespace eti::pbd {

void RodChain::factorize() {
    for (std::size_t i = 0; i < size(); ++i) {
        if (i > 0) {
            // With L L^T = pivot: link := L^-1 link; link^T link is subtracted from the next pivot.
            factor_[i - 1].matrixL().solveInPlace(link_[i - 1]);
            pivot_[i].noalias() -= link_[i - 1].transpose() * link_[i - 1];
        }
        factor_[i].compute(pivot_[i]);
    }
}

void RodChain::solve(std::span<Vec6d> rhs) const {
    solve_from(0, rhs);
}

void RodChain::solve_from(std::size_t first, std::span<Vec6d> rhs) const {
    for (std::size_t i = first; i < size(); ++i) {
        if (i > first) {
            rhs[i].noalias() -= link_[i - 1].transpose() * rhs[i - 1];
        }
        factor_[i].matrixL().solveInPlace(rhs[i]);
    }
    for (std::size_t i = size(); i-- > 0;) {
        if (i + 1 < size()) {
            rhs[i].noalias() -= link_[i] * rhs[i + 1];
        }
        factor_[i].matrixU().solveInPlace(rhs[i]);
    }
}

}  // namespace eti::pbd
