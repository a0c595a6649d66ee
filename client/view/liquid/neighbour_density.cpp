// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/neighbour_density.hpp"

#include <algorithm>
#include <cmath>

namespace eti::view {

void NeighbourDensity::count(std::span<const Vec3f> positions, float spacing) {
    constexpr float farthest = 1.5f;  // [spacings]
    const float reach = farthest * spacing;
    cells_.fill(positions, reach);
    densities_.assign(positions.size(), 0.0f);
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        cells_.visit_near(positions[i], [&](std::uint32_t k) {
            const float squared = (positions[k] - positions[i]).squaredNorm();
            if (k != i && squared < reach * reach) {
                densities_[i] += std::min(2.0f * (farthest - std::sqrt(squared) / spacing), 1.0f);
            }
        });
    }
}

}  // namespace eti::view
