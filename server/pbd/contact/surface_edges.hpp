// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace eti::pbd {

/// Surface triangles of a tetrahedral mesh, which belong to one tetrahedron only: corners ascending; the
/// triangles, too.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> surface_triangles(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra);

/// The edges of these triangles: pairs of particles, lower index first; ascending and unique.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> surface_edges(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra);

}  // namespace eti::pbd
