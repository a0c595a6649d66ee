// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::pbd {

/// Sorts points into cubic cells, so that a point's neighbours lie in nine runs of the sorted order. Only
/// cells within the points' bounding box are counted. No allocation after construction.
class CellGrid {
  public:
    using Run = std::pair<std::uint32_t, std::uint32_t>;  ///< first and one past the last position in the
                                                          ///< sorted order

    /// Throws std::invalid_argument if the domain is empty or has too many cells.
    CellGrid(const Vec3f& lower, const Vec3f& upper, float cell, std::size_t capacity);

    /// Stable counting sort; cells in the order z, y, x, independent of the bounding box. Points must lie
    /// within the domain. Afterwards order()[k] is the index of the k-th point.
    void sort(std::span<const Vec3f> points);
    [[nodiscard]] std::span<const std::uint32_t> order() const { return {order_.data(), count_}; }
    /// Whether the points were already sorted.
    [[nodiscard]] bool was_sorted() const { return was_sorted_; }
    /// The cell of the point at position `place` of the sorted order.
    [[nodiscard]] std::uint32_t cell_at(std::size_t place) const { return cell_[order_[place]]; }
    /// Runs of the points in the 27 cells around `cell`.
    [[nodiscard]] std::array<Run, 9> neighbours(std::uint32_t cell) const;

    /// Run of the points in `cell`.
    [[nodiscard]] Run within(std::uint32_t cell) const { return {start_[cell], start_[cell + 1]}; }
    /// Centre of the occupied cells [m].
    [[nodiscard]] const Vec3f& middle() const { return middle_; }

    /// Lower corner of the domain [m].
    [[nodiscard]] const Vec3f& lower() const { return lower_; }
    [[nodiscard]] bool contains(const Vec3f& point) const {
        return (point.array() >= lower_.array()).all() && (point.array() < upper_.array()).all();
    }

  private:
    [[nodiscard]] Eigen::Vector3i place_of(const Vec3f& point) const {
        return ((point - lower_) * inverse_cell_).cast<int>();
    }

    Vec3f lower_, upper_;
    float inverse_cell_;
    Vec3f middle_ = Vec3f::Zero();
    std::size_t count_ = 0;
    bool was_sorted_ = true;
    std::uint32_t row_ = 0;             ///< cells in a row along x, with one empty cell on either side
    std::uint32_t layer_ = 0;           ///< cells in a layer of rows
    std::vector<std::uint32_t> start_;  ///< [cells + 1]: position of a cell's first point in the sorted order
    std::vector<std::uint32_t> cell_;   ///< [points]
    std::vector<std::uint32_t> order_;  ///< [points]: indices in the sorted order
};

}  // namespace eti::pbd
