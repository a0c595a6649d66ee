// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace eti::pbd {

/// Surface edges of a tetrahedral mesh: the edges of triangles that belong to one tetrahedron only. Pairs of
/// particles, lower index first; ascending and unique.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> surface_edges(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra);

}  // namespace eti::pbd
