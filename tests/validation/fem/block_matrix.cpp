// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/block_matrix.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace eti::fem {

using Eigen::Index;

BlockMatrix::BlockMatrix(std::size_t vertices, const std::vector<std::array<std::uint32_t, 2>>& pairs,
                         std::vector<bool> held)
    : held_(std::move(held)), matrix_(3 * static_cast<Index>(vertices), 3 * static_cast<Index>(vertices)) {
    std::vector<std::array<std::uint32_t, 2>> both;
    for (std::uint32_t i = 0; i < vertices; ++i) {
        both.push_back({i, i});
    }
    for (const auto& [a, b] : pairs) {
        if (!all_held(a) && !all_held(b)) {
            both.push_back({a, b});
            both.push_back({b, a});
        }
    }
    std::ranges::sort(both);
    const auto repeated = std::ranges::unique(both);
    both.erase(repeated.begin(), repeated.end());
    first_.assign(vertices + 1, 0);
    for (const auto& [a, b] : both) {
        ++first_[a + 1];
        joined_.push_back(b);
    }
    for (std::size_t i = 0; i < vertices; ++i) {
        first_[i + 1] += first_[i];
    }
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(9 * both.size());
    for (const auto& [a, b] : both) {
        for (std::uint32_t k = 0; k < 9; ++k) {
            entries.emplace_back(static_cast<Index>(3 * a + k % 3), static_cast<Index>(3 * b + k / 3), 0.0);
        }
    }
    matrix_.setFromTriplets(entries.begin(), entries.end());
}

bool BlockMatrix::all_held(std::uint32_t vertex) const {
    return held_[3 * vertex] && held_[3 * vertex + 1] && held_[3 * vertex + 2];
}

void BlockMatrix::add(std::uint32_t a, std::uint32_t b, const Eigen::Matrix3d& block) {
    if (all_held(a) || all_held(b)) {
        return;
    }
    const auto begin = joined_.begin() + first_[b];
    const auto found = std::lower_bound(begin, joined_.begin() + first_[b + 1], a);
    assert(found != joined_.begin() + first_[b + 1] && *found == a);
    const Index rank = 3 * (found - begin);
    for (Index c = 0; c < 3; ++c) {
        double* at = matrix_.valuePtr() + matrix_.outerIndexPtr()[3 * static_cast<Index>(b) + c] + rank;
        for (Index r = 0; r < 3; ++r) {
            at[r] += block(r, c);
        }
    }
}

void BlockMatrix::hold() {
    for (Index c = 0; c < matrix_.outerSize(); ++c) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, c); it; ++it) {
            if (held_[static_cast<std::size_t>(it.row())] || held_[static_cast<std::size_t>(c)]) {
                it.valueRef() = it.row() == c ? 1.0 : 0.0;
            }
        }
    }
}

bool BlockMatrix::factorise() {
    if (!analysed_) {
        factor_.analyzePattern(matrix_);
        analysed_ = true;
    }
    factor_.factorize(matrix_);
    return factor_.info() == Eigen::Success && factor_.vectorD().minCoeff() > 0.0;
}

}  // namespace eti::fem
