// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"

namespace eti {

/// Points sorted into cubic cells, for neighbour queries.
class PointGrid {
  public:
    PointGrid(std::span<const Vec3f> points, float cell) : points_(points), cell_(cell) {
        if (points.empty()) {
            low_.setZero();
            start_.assign(2, 0);
            return;
        }
        Vec3f high = points[0];
        low_ = points[0];
        for (const Vec3f& p : points) {
            low_ = low_.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        for (int k = 0; k < 3; ++k) {
            size_[k] = static_cast<int>((high[k] - low_[k]) / cell) + 1;
        }
        start_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2] + 1, 0);
        for (const Vec3f& p : points) {
            ++start_[cell_of(p) + 1];
        }
        for (std::size_t c = 1; c < start_.size(); ++c) {
            start_[c] += start_[c - 1];
        }
        order_.resize(points.size());
        std::vector<std::uint32_t> cursor(start_.begin(), start_.end() - 1);
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            order_[cursor[cell_of(points[i])]++] = i;
        }
    }

    /// Calls visit(index, squared distance) for every point within `radius` of `centre`, in a fixed order.
    template <class Visit>
    void within(const Vec3f& centre, float radius, const Visit& visit) const {
        if (points_.empty()) {
            return;
        }
        int from[3], to[3];
        for (int k = 0; k < 3; ++k) {
            from[k] = std::max(0, static_cast<int>(std::floor((centre[k] - radius - low_[k]) / cell_)));
            to[k] =
                std::min(size_[k] - 1, static_cast<int>(std::floor((centre[k] + radius - low_[k]) / cell_)));
        }
        for (int z = from[2]; z <= to[2]; ++z) {
            for (int y = from[1]; y <= to[1]; ++y) {
                for (int x = from[0]; x <= to[0]; ++x) {
                    const std::size_t c = index(x, y, z);
                    for (std::uint32_t k = start_[c]; k < start_[c + 1]; ++k) {
                        const float squared = (points_[order_[k]] - centre).squaredNorm();
                        if (squared <= radius * radius) {
                            visit(order_[k], squared);
                        }
                    }
                }
            }
        }
    }

  private:
    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * size_[1] + static_cast<std::size_t>(y)) * size_[0] + x;
    }
    [[nodiscard]] std::size_t cell_of(const Vec3f& p) const {
        int c[3];
        for (int k = 0; k < 3; ++k) {
            c[k] = std::clamp(static_cast<int>((p[k] - low_[k]) / cell_), 0, size_[k] - 1);
        }
        return index(c[0], c[1], c[2]);
    }

    std::span<const Vec3f> points_;
    float cell_;
    Vec3f low_;
    int size_[3] = {1, 1, 1};
    std::vector<std::uint32_t> start_, order_;
};

}  // namespace eti
