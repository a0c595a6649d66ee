// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::bench {

/// Where a deformed tetrahedral mesh lies.
struct TissueVolume {
    double share = 0.0;           ///< sum of the signed volumes over that at rest
    double occupied = 0.0;        ///< [m^3] that lie in at least one tetrahedron
    double doubly_covered = 0.0;  ///< [m^3] that lie in more than one
    std::size_t inverted = 0;     ///< tetrahedra of negative volume
    std::size_t crushed = 0;      ///< below half of their volume
};

/// Covered volumes by points of a regular grid of `pitch` [m].
[[nodiscard]] TissueVolume volume_of(std::span<const std::array<std::uint32_t, 4>> tetrahedra,
                                     const std::vector<Vec3f>& rest, const std::vector<Vec3f>& position,
                                     double pitch = 0.5e-3);

}  // namespace eti::bench
