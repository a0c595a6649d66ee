// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/coarse_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "synthetic_scene.hpp"

namespace eti {
namespace {

std::vector<view::LitVertex> lit(const TriangleMesh& mesh) {
    std::vector<view::LitVertex> vertices(mesh.vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].position = mesh.vertices[v];
    }
    view::recompute_normals(mesh.triangles, vertices);
    return vertices;
}

double volume(std::span<const Triangle> triangles, const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const Triangle& t : triangles) {
        sum += static_cast<double>(mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) /
                                   6.0f);
    }
    return sum;
}

TEST(CoarseMesh, PreservesVolumeWithFewerTriangles) {
    const TriangleMesh mesh = synthetic::body_mesh();
    const auto coarse = render::coarse_triangles(mesh.triangles, lit(mesh), 5e-3f);
    EXPECT_LT(coarse.size(), mesh.triangles.size() / 2);
    EXPECT_GT(coarse.size(), mesh.triangles.size() / 50);
    const double whole = volume(mesh.triangles, mesh);
    // Cells of 5 mm in a head of 100 mm: chords of that length lie 5^2 / (8 * 50) = 0.06 mm within it.
    EXPECT_NEAR(volume(coarse, mesh), whole, 0.03 * whole);
}

TEST(CoarseMesh, FineCellsKeepMeshUnchanged) {
    const TriangleMesh mesh = synthetic::body_mesh();
    EXPECT_EQ(render::coarse_triangles(mesh.triangles, lit(mesh), 1e-6f), mesh.triangles);
}

// Two sheets closer than a cell that face each other, as lips do.
TEST(CoarseMesh, OppositelyFacingSheetsAreNotMerged) {
    TriangleMesh sheets;
    for (const float y : {-0.1e-3f, 0.1e-3f}) {
        const auto first = static_cast<std::uint32_t>(sheets.vertices.size());
        for (int i = 0; i < 4; ++i) {
            sheets.vertices.emplace_back(4e-3f * static_cast<float>(i % 2) + 1e-3f, y + 1e-3f,
                                         4e-3f * static_cast<float>(i / 2) + 1e-3f);
        }
        y < 0.0f ? sheets.triangles.push_back({first, first + 1, first + 2})
                 : sheets.triangles.push_back({first, first + 2, first + 1});
    }
    const auto coarse = render::coarse_triangles(sheets.triangles, lit(sheets), 3e-3f);
    ASSERT_EQ(coarse.size(), 2u);
    EXPECT_LT(*std::ranges::max_element(coarse[0]), 4u);
    EXPECT_GE(*std::ranges::min_element(coarse[1]), 4u);
}

}  // namespace
}  // namespace eti
