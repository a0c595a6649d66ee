// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::view {

/// Points by cell: finds neighbours in time proportional to their number (spatial hashing, Teschner et al.
/// 2003). Hashing needs no bounding box, as liquid received over the bus may lie anywhere.
class SpatialHash {
  public:
    /// `size` [m]: cell size, and the largest radius that visit_near() covers completely.
    void fill(std::span<const Vec3f> points, float size) {
        size_ = size;
        cells_.resize(points.size());
        const std::size_t buckets = std::bit_ceil(2 * points.size() + 1);
        mask_ = static_cast<std::uint32_t>(buckets - 1);
        first_.assign(buckets + 1, 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            cells_[i] = cell_of(points[i]);
            ++first_[bucket(cells_[i]) + 1];
        }
        for (std::size_t b = 0; b < buckets; ++b) {
            first_[b + 1] += first_[b];
        }
        next_.assign(first_.begin(), first_.end() - 1);
        sorted_.resize(points.size());
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            sorted_[next_[bucket(cells_[i])]++] = i;
        }
    }

    /// Calls `visit` with each point in the cells around `place`, in an order that depends on the points
    /// only.
    template <class Visit>
    void visit_near(const Vec3f& place, const Visit& visit) const {
        if (sorted_.empty()) {
            return;
        }
        const Cell middle = cell_of(place);
        for (int k = 0; k < 27; ++k) {
            const Cell cell = middle + Cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            const std::uint32_t at = bucket(cell);
            for (std::uint32_t s = first_[at]; s < first_[at + 1]; ++s) {
                // Other cells may share the bucket.
                if (cells_[sorted_[s]] == cell) {
                    visit(sorted_[s]);
                }
            }
        }
    }

  private:
    using Cell = Eigen::Vector3i;

    [[nodiscard]] Cell cell_of(const Vec3f& p) const {
        return (p / size_).array().floor().matrix().cast<int>();
    }
    [[nodiscard]] std::uint32_t bucket(const Cell& c) const {
        return (static_cast<std::uint32_t>(c.x()) * 73856093u ^
                static_cast<std::uint32_t>(c.y()) * 19349663u ^
                static_cast<std::uint32_t>(c.z()) * 83492791u) &
               mask_;
    }

    float size_ = 1e-3f;
    std::uint32_t mask_ = 0;
    std::vector<Cell> cells_;
    std::vector<std::uint32_t> first_, next_, sorted_;
};

}  // namespace eti::view
