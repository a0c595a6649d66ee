// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/cells_of.hpp"

#include <algorithm>
#include <cstddef>

namespace eti::patient {

namespace {

using Corners = std::array<std::uint32_t, 4>;

/// Whether these are a cell's inner tetrahedron and the four that cut off its other corners: each has a
/// corner of its own, then a face of the inner one, in the order of the faces.
bool are_cell(std::span<const Corners> five) {
    constexpr std::size_t faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
    const Corners& inner = five[0];
    for (std::size_t k = 0; k < 4; ++k) {
        const Corners& outer = five[k + 1];
        if (std::ranges::find(inner, outer[0]) != inner.end() || outer[1] != inner[faces[k][0]] ||
            outer[2] != inner[faces[k][1]] || outer[3] != inner[faces[k][2]]) {
            return false;
        }
    }
    return true;
}

}  // namespace

Cells cells_of(std::span<const std::uint32_t> tetrahedra, const Patient& patient) {
    std::vector<Corners> all;
    all.reserve(tetrahedra.size());
    for (const std::uint32_t t : tetrahedra) {
        all.push_back(patient.tetrahedra.corners[t]);
    }
    Cells cells;
    for (std::size_t t = 0; t < all.size();) {
        if (t + 5 <= all.size() && are_cell(std::span(all).subspan(t, 5))) {
            // The inner tetrahedron has the corners 1, 2, 4, 7; a cell of the other handedness is mirrored.
            cells.hexahedra.push_back({all[t + 1][0], all[t][0], all[t][1], all[t + 2][0], all[t][2],
                                       all[t + 3][0], all[t + 4][0], all[t][3]});
            t += 5;
        } else {
            cells.tetrahedra.push_back(all[t]);
            ++t;
        }
    }
    return cells;
}

}  // namespace eti::patient
