// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/surface_edges.hpp"

#include <algorithm>

namespace eti::pbd {

std::vector<std::array<std::uint32_t, 3>> surface_triangles(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra) {
    // A face shared by two tetrahedra is interior.
    std::vector<std::array<std::uint32_t, 3>> faces;
    faces.reserve(4 * tetrahedra.size());
    for (const auto& corners : tetrahedra) {
        for (std::size_t out = 0; out < 4; ++out) {
            std::array face = {corners[(out + 1) % 4], corners[(out + 2) % 4], corners[(out + 3) % 4]};
            std::ranges::sort(face);
            faces.push_back(face);
        }
    }
    std::ranges::sort(faces);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (auto face = faces.begin(); face != faces.end();) {
        const auto next = std::find_if(face, faces.end(), [&](const auto& other) { return other != *face; });
        if (next - face == 1) {
            triangles.push_back(*face);
        }
        face = next;
    }
    return triangles;
}

std::vector<std::array<std::uint32_t, 2>> surface_edges(
    std::span<const std::array<std::uint32_t, 4>> tetrahedra) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const auto& [a, b, c] : surface_triangles(tetrahedra)) {
        edges.insert(edges.end(), {{a, b}, {a, c}, {b, c}});
    }
    std::ranges::sort(edges);
    const auto repeated = std::ranges::unique(edges);
    edges.erase(repeated.begin(), repeated.end());
    return edges;
}

}  // namespace eti::pbd
