// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/distance_grid.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/newborn/anatomy.hpp"

namespace eti::patient {

/// A grid over a box, with values unset.
[[nodiscard]] inline DistanceGrid grid_over(const Vec3f& low, const Vec3f& high, float spacing) {
    DistanceGrid grid;
    grid.origin = low;
    grid.spacing = spacing;
    grid.size = grid_nodes(low, high, spacing);
    grid.value.resize(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2]);
    return grid;
}

/// Evaluates the fields once per node of a grid and calls `store(node index, fields, point)`.
template <class Store>
void sample(const Anatomy& anatomy, const DistanceGrid& grid, const Store& store) {
    parallel::for_each(grid.size[2], 1, [&](int z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3f point = grid.node(x, y, z);
                store(grid.index(x, y, z), anatomy.fields(point), point);
            }
        }
    });
}

}  // namespace eti::patient
