// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/components.hpp"

#include <algorithm>

namespace eti {

std::uint32_t Components::largest() const {
    return static_cast<std::uint32_t>(std::max_element(voxels.begin(), voxels.end()) - voxels.begin());
}

Components components(const std::array<int, 3>& size, std::span<const std::uint8_t> mask) {
    Components found;
    found.part.assign(mask.size(), 0);
    found.voxels.push_back(0);
    std::vector<std::size_t> open;
    for (std::size_t seed = 0; seed < mask.size(); ++seed) {
        if (mask[seed] == 0 || found.part[seed] != 0) {
            continue;
        }
        const auto number = static_cast<std::uint32_t>(found.voxels.size());
        std::size_t voxels = 0;
        found.part[seed] = number;
        open.assign(1, seed);
        while (!open.empty()) {
            const std::size_t i = open.back();
            open.pop_back();
            ++voxels;
            const auto visit = [&](std::size_t other) {
                if (mask[other] != 0 && found.part[other] == 0) {
                    found.part[other] = number;
                    open.push_back(other);
                }
            };
            for_each_neighbour(size, i, visit);
        }
        found.voxels.push_back(voxels);
    }
    return found;
}

}  // namespace eti
