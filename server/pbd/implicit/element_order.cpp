// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/element_order.hpp"

#include <limits>
#include <numeric>

namespace eti::pbd {

namespace {

// Spreads 20 bits to every third bit of a Morton code.
std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x1f00000000ffffULL;
    bits = (bits | bits << 16) & 0x1f0000ff0000ffULL;
    bits = (bits | bits << 8) & 0x100f00f00f00f00fULL;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ULL;
    return (bits | bits << 2) & 0x1249249249249249ULL;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3d> points) {
    Vec3d low = Vec3d::Constant(std::numeric_limits<double>::max());
    Vec3d high = -low;
    for (const Vec3d& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const double scale = 0xfffff / std::max((high - low).maxCoeff(), 1e-12);
    std::vector<std::uint64_t> key(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec3d at = scale * (points[k] - low);
        key[k] = spread(static_cast<std::uint64_t>(at.x())) |
                 spread(static_cast<std::uint64_t>(at.y())) << 1 |
                 spread(static_cast<std::uint64_t>(at.z())) << 2;
    }
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    return order;
}

}  // namespace eti::pbd
