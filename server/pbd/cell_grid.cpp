// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/cell_grid.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace eti::pbd {

CellGrid::CellGrid(const Vec3f& lower, const Vec3f& upper, float cell, std::size_t capacity)
    : lower_(lower), upper_(upper), inverse_cell_(1.0f / cell) {
    constexpr double most = 64e6;  // 256 MB
    const Eigen::Array3d cells = ((upper - lower).cast<double>() / cell).array().floor() + 3.0;
    if (!(cells.minCoeff() >= 3.0) || !(cells.prod() < most)) {
        throw std::invalid_argument("domain of " + std::to_string(upper.x() - lower.x()) + " x " +
                                    std::to_string(upper.y() - lower.y()) + " x " +
                                    std::to_string(upper.z() - lower.z()) + " m in cells of " +
                                    std::to_string(cell) +
                                    " m: expected at most 64 million cells and a positive extent; shrink the "
                                    "domain or use larger cells");
    }
    start_.resize(static_cast<std::size_t>(cells.prod()) + 1, 0);
    cell_.resize(capacity, 0);
    order_.resize(capacity, 0);
}

void CellGrid::sort(std::span<const Vec3f> points) {
    count_ = points.size();
    Eigen::Vector3i low = Eigen::Vector3i::Constant(1 << 30);
    Eigen::Vector3i high = Eigen::Vector3i::Zero();
    for (const Vec3f& point : points) {
        const Eigen::Vector3i place = place_of(point);
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    if (points.empty()) {
        was_sorted_ = true;
        return;
    }
    middle_ = lower_ + (low + high + Eigen::Vector3i::Ones()).cast<float>() * (0.5f / inverse_cell_);
    const Eigen::Vector3i size = high - low + Eigen::Vector3i::Constant(3);
    row_ = static_cast<std::uint32_t>(size.x());
    layer_ = row_ * static_cast<std::uint32_t>(size.y());
    const std::size_t cells = static_cast<std::size_t>(layer_) * static_cast<std::size_t>(size.z());
    std::fill_n(start_.begin(), cells + 1, 0u);
    bool sorted = true;
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < count_; ++i) {
        const Eigen::Vector3i place = place_of(points[i]) - low + Eigen::Vector3i::Ones();
        cell_[i] = static_cast<std::uint32_t>(place.x()) + row_ * static_cast<std::uint32_t>(place.y()) +
                   layer_ * static_cast<std::uint32_t>(place.z());
        ++start_[cell_[i]];
        sorted = sorted && cell_[i] >= last;
        last = cell_[i];
    }
    was_sorted_ = sorted;
    std::uint32_t sum = 0;
    for (std::size_t c = 0; c <= cells; ++c) {
        sum += start_[c];
        start_[c] = sum;
    }
    // Backwards, so that each start ends up at its cell's first position.
    for (std::size_t i = count_; i-- > 0;) {
        order_[--start_[cell_[i]]] = static_cast<std::uint32_t>(i);
    }
}

std::array<CellGrid::Run, 9> CellGrid::neighbours(std::uint32_t cell) const {
    std::array<Run, 9> runs;
    std::size_t k = 0;
    for (std::uint32_t z = 0; z < 3; ++z) {
        for (std::uint32_t y = 0; y < 3; ++y) {
            const std::uint32_t first = cell + z * layer_ + y * row_ - layer_ - row_ - 1;
            runs[k++] = {start_[first], start_[first + 3]};
        }
    }
    return runs;
}

}  // namespace eti::pbd
