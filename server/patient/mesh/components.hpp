// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace eti {

/// Visits the voxels of a grid, x fastest, that share a face with voxel `i`.
template <class Visit>
void for_each_neighbour(const std::array<int, 3>& size, std::size_t i, const Visit& visit) {
    const auto nx = static_cast<std::size_t>(size[0]);
    const std::size_t slice = nx * static_cast<std::size_t>(size[1]);
    const std::size_t all = slice * static_cast<std::size_t>(size[2]);
    const std::size_t x = i % nx;
    const std::size_t y = i % slice / nx;
    if (x > 0) {
        visit(i - 1);
    }
    if (x + 1 < nx) {
        visit(i + 1);
    }
    if (y > 0) {
        visit(i - nx);
    }
    if ((y + 1) * nx < slice) {
        visit(i + nx);
    }
    if (i >= slice) {
        visit(i - slice);
    }
    if (i + slice < all) {
        visit(i + slice);
    }
}

/// Face-connected components of a mask, 0 or 1 per voxel, x fastest.
struct Components {
    std::vector<std::uint32_t> part;  ///< per voxel: component number; 0 outside the mask
    std::vector<std::size_t> voxels;  ///< per component; entry 0 is unused and 0

    /// Number of the largest component; 0 if there is none.
    [[nodiscard]] std::uint32_t largest() const;
};
[[nodiscard]] Components components(const std::array<int, 3>& size, std::span<const std::uint8_t> mask);

}  // namespace eti
