// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/contact/surface_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::pbd {
namespace {

using Edge = std::array<std::uint32_t, 2>;

TEST(SurfaceEdges, SingleTetrahedronHasSixEdges) {
    const std::vector<std::array<std::uint32_t, 4>> one = {{7, 2, 5, 3}};
    EXPECT_EQ(surface_edges(one), (std::vector<Edge>{{2, 3}, {2, 5}, {2, 7}, {3, 5}, {3, 7}, {5, 7}}));
    EXPECT_TRUE(surface_edges({}).empty());
}

// Euler's polyhedron formula: a closed surface of triangles without handles has 3 (points - 2) edges.
TEST(SurfaceEdges, BoxEdgeCountSatisfiesEulerFormula) {
    const test::TetrahedralLattice box = test::tetrahedral_lattice(4, 3, 5, 1.0);
    const std::vector<Edge> edges = surface_edges(box.tetrahedra);
    EXPECT_EQ(edges.size(), 3u * (5 * 4 * 6 - 3 * 2 * 4 - 2));
    EXPECT_TRUE(std::ranges::is_sorted(edges));
    EXPECT_EQ(std::ranges::adjacent_find(edges), edges.end());
    const Vec3d far(4.0, 3.0, 5.0);
    for (const auto& [a, b] : edges) {
        EXPECT_LT(a, b);
        const Vec3d middle = 0.5 * (box.position[a] + box.position[b]);
        EXPECT_EQ(std::min(middle.minCoeff(), (far - middle).minCoeff()), 0.0) << a << " to " << b;
    }
}

}  // namespace
}  // namespace eti::pbd
