// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/check.hpp"

#include <gtest/gtest.h>

#include "common/mesh/intersect.hpp"
#include "tests/unit/common/mesh/shapes.hpp"

namespace eti {
namespace {

// Octahedron of half diagonal s: volume 4/3 s^3, area 4 sqrt(3) s^2. Tolerance: coordinates are exact
// here, so only double rounding remains.
TEST(MeshCheck, OctahedronIsSound) {
    const MeshReport report = check(test::octahedron(0.5f));
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.vertices, 6u);
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, 2);
    EXPECT_NEAR(report.volume, 4.0 / 3.0 * 0.125, 1e-15);
    EXPECT_NEAR(report.area, 4.0 * std::sqrt(3.0) * 0.25, 1e-15);
}

TEST(MeshCheck, FindsAHole) {
    TriangleMesh mesh = test::octahedron(1.0f);
    mesh.triangles.pop_back();
    const MeshReport report = check(mesh);
    EXPECT_EQ(report.open_edges, 3u);
    EXPECT_EQ(report.euler_characteristic, 1);
    EXPECT_FALSE(report.is_valid());
}

TEST(MeshCheck, FindsATurnedTriangle) {
    TriangleMesh mesh = test::octahedron(1.0f);
    std::swap(mesh.triangles[3][1], mesh.triangles[3][2]);
    EXPECT_EQ(check(mesh).misoriented_edges, 3u);
}

TEST(MeshCheck, FindsADegenerateTriangle) {
    TriangleMesh mesh = test::octahedron(1.0f);
    mesh.vertices[0] = mesh.vertices[2];
    // The two triangles that hold both vertices lose their area.
    EXPECT_EQ(check(mesh).degenerate_triangles, 2u);
}

TEST(MeshCheck, LocatesTheFault) {
    TriangleMesh mesh = test::octahedron(1.0f);
    EXPECT_FALSE(check(mesh).fault_at);
    const Triangle hole = mesh.triangles.back();
    mesh.triangles.pop_back();
    const auto place = check(mesh).fault_at;
    ASSERT_TRUE(place);
    EXPECT_TRUE(*place == mesh.vertices[hole[0]] || *place == mesh.vertices[hole[1]] ||
                *place == mesh.vertices[hole[2]]);
}

TEST(MeshCheck, FindsANonManifoldEdge) {
    TriangleMesh mesh = test::octahedron(1.0f);
    mesh.vertices.push_back(Vec3f(2.0f, 2.0f, 2.0f));
    mesh.triangles.push_back({0, 2, 6});
    const MeshReport report = check(mesh);
    EXPECT_EQ(report.nonmanifold_edges, 1u);
    EXPECT_EQ(report.open_edges, 2u);
}

// Two octahedra that share only a vertex: all edges are manifold, the vertex is not.
TEST(MeshCheck, FindsAPinchedVertex) {
    TriangleMesh mesh = test::octahedron(1.0f);
    const TriangleMesh other = test::octahedron(1.0f);
    // The other's vertex 1 (-x) becomes the first one's vertex 0 (+x).
    for (const Vec3f& v : other.vertices) {
        mesh.vertices.push_back(v + Vec3f(2.0f, 0.0f, 0.0f));
    }
    for (const Triangle& t : other.triangles) {
        Triangle moved{};
        for (std::size_t k = 0; k < 3; ++k) {
            moved[k] = t[k] == 1 ? 0 : t[k] + 6;
        }
        mesh.triangles.push_back(moved);
    }
    const MeshReport report = check(mesh);
    EXPECT_EQ(report.pinched_vertices, 1u);
    EXPECT_EQ(report.open_edges + report.nonmanifold_edges + report.misoriented_edges, 0u);
    EXPECT_EQ(report.components, 1u);
}

// Two octahedra that interpenetrate along x by less than a half diagonal, rotated out of symmetry so that no
// edges meet: they must intersect, and must not once they are apart.
TEST(MeshCheck, FindsCrossingTriangles) {
    for (const float gap : {1.37f, 2.01f}) {
        TriangleMesh mesh = test::octahedron(1.0f);
        const Quatf turn(Eigen::AngleAxisf(0.3f, Vec3f(1.0f, 0.0f, 0.0f)));
        for (const Vec3f& v : test::octahedron(1.0f).vertices) {
            mesh.vertices.push_back(turn * v + Vec3f(gap, 0.0f, 0.0f));
        }
        for (const Triangle& t : test::octahedron(1.0f).triangles) {
            mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
        }
        const MeshReport report = check(mesh);
        EXPECT_EQ(report.self_intersections > 0, gap < 2.0f) << report.describe();
        EXPECT_EQ(report.components, 2u);
    }
}

// The reference tests every pair of triangles, without the search's cells.
TEST(MeshCheck, CellSearchMatchesBruteForce) {
    TriangleMesh mesh;
    std::uint32_t state = 12345;
    const auto next = [&state] {
        state = state * 1664525u + 1013904223u;
        return static_cast<float>(state >> 8) * 0x1p-24f;
    };
    for (std::uint32_t i = 0; i < 200; ++i) {
        const Vec3f centre(next(), next(), next());
        for (int k = 0; k < 3; ++k) {
            mesh.vertices.push_back(centre + 0.3f * Vec3f(next(), next(), next()));
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    std::vector<std::array<std::uint32_t, 2>> expected;
    const auto pierces = [&](const Triangle& e, const Triangle& f) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (crosses(mesh.vertices[e[k]], mesh.vertices[e[(k + 1) % 3]], mesh.vertices[f[0]],
                        mesh.vertices[f[1]], mesh.vertices[f[2]])) {
                return true;
            }
        }
        return false;
    };
    for (std::uint32_t i = 0; i < 200; ++i) {
        for (std::uint32_t j = i + 1; j < 200; ++j) {
            if (pierces(mesh.triangles[i], mesh.triangles[j]) ||
                pierces(mesh.triangles[j], mesh.triangles[i])) {
                expected.push_back({i, j});
            }
        }
    }
    ASSERT_GT(expected.size(), 20u);
    EXPECT_EQ(self_intersections(mesh), expected);

    // Query for some triangles only.
    std::vector<std::uint8_t> asked(mesh.triangles.size(), 0);
    for (std::size_t i = 0; i < asked.size(); i += 7) {
        asked[i] = 1;
    }
    std::erase_if(expected, [&](const auto& pair) { return (asked[pair[0]] | asked[pair[1]]) == 0; });
    ASSERT_GT(expected.size(), 5u);
    EXPECT_EQ(self_intersections(mesh, asked), expected);
    EXPECT_TRUE(self_intersections(mesh, std::vector<std::uint8_t>(asked.size(), 0)).empty());
}

}  // namespace
}  // namespace eti
