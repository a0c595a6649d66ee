// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace eti::pbd {

/// Edges of a tetrahedral mesh's surface: those of triangles that belong to one tetrahedron only. Particles,
/// the lower number first; ascending, each edge once.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> surface_edges(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra);

}  // namespace eti::pbd
