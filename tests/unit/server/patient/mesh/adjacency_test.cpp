// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>

#include "server/patient/mesh/adjacency.hpp"

namespace eti {
namespace {

// An octahedron: each vertex is joined to all others except the opposite one, whose index differs in the
// lowest bit.
TriangleMesh octahedron() {
    TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        mesh.vertices.push_back(Vec3f::Unit(axis));
        mesh.vertices.push_back(-Vec3f::Unit(axis));
    }
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

TEST(Adjacency, NamesEachNeighbourOnce) {
    const Adjacency around(octahedron());
    ASSERT_EQ(around.vertices(), 6u);
    for (std::uint32_t v = 0; v < 6; ++v) {
        EXPECT_EQ(around.of(v).size(), 4u);
        for (std::uint32_t to = 0; to < 6; ++to) {
            EXPECT_EQ(std::ranges::count(around.of(v), to), to == v || to == (v ^ 1u) ? 0 : 1);
        }
    }
    EXPECT_EQ(around.first(5), 20u);
}

TEST(Adjacency, WidensByOneEdge) {
    const Adjacency around(octahedron());
    EXPECT_EQ(around.dilated({1, 0, 0, 0, 0, 0}), (std::vector<std::uint8_t>{1, 0, 1, 1, 1, 1}));
}

}  // namespace
}  // namespace eti
