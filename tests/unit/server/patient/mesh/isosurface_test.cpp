// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/isosurface.hpp"

#include <gtest/gtest.h>

#include "common/mesh/check.hpp"
#include "server/patient/mesh/normals.hpp"
#include "server/patient/mesh/smooth.hpp"
#include "tests/unit/common/mesh/shapes.hpp"

namespace eti {
namespace {

template <typename Shape>
class Isosurface : public testing::Test {};
using Shapes = testing::Types<test::Sphere, test::Torus>;
TYPED_TEST_SUITE(Isosurface, Shapes);

// Linear interpolation places vertices within k h^2 / 8 of the surface (k: curvature; edges up to sqrt(3) h
// long, so 3 k h^2 / 8). Chords lie as deep again, and the clearance at nodes adds 0.035 h. The volume's
// error is at most the area times that depth.
TYPED_TEST(Isosurface, HasTheShapesVolumeAreaAndTopology) {
    const TypeParam shape;
    const float spacing = 0.0005f;
    const TriangleMesh mesh = isosurface(test::sample_grid(shape, shape.half_extent, spacing), 0.0f);
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, TypeParam::euler_characteristic);
    const double curvature = 1.0 / 0.003;  // the torus's tube; the sphere's is less
    const double depth = 0.75 * curvature * std::pow(double{spacing}, 2) + 0.035 * double{spacing};
    EXPECT_NEAR(report.volume, shape.volume(), shape.area() * depth);
    EXPECT_NEAR(report.area, shape.area(), shape.area() * 2.0 * curvature * depth);
    for (const Vec3f& v : mesh.vertices) {
        ASSERT_LT(std::abs(shape(v)), depth);
    }
}

// Where a node lies almost on the surface, its clearance of 0.02 h tilts triangles that are no larger than
// that; smoothing removes this, and normals are used only afterwards. What remains is the tilt of facets with
// edges e of at most sqrt(3) h on a radius r, e / 2r to either side of the vertex. That is cos(0.87 mm / 6
// mm) = 0.99, and as much again for noise of the smoothed positions.
TYPED_TEST(Isosurface, NormalsPointTowardsIncreasingField) {
    const TypeParam shape;
    const float spacing = 0.0005f;
    TriangleMesh mesh = isosurface(test::sample_grid(shape, shape.half_extent, spacing), 0.0f);
    smooth(mesh, 5);
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    const float step = 0.1f * spacing;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const float slope =
            (shape(mesh.vertices[v] + step * normals[v]) - shape(mesh.vertices[v] - step * normals[v])) /
            (2.0f * step);
        ASSERT_GT(slope, 0.98f);
    }
}

TEST(IsosurfaceBorder, SolidThatReachesTheBorderIsCapped) {
    const test::Sphere sphere;
    DistanceGrid grid = test::sample_grid(sphere, 0.006f, 0.0005f);  // smaller than the sphere
    const MeshReport closed = check(isosurface(grid, 0.0f, Border::closed));
    EXPECT_TRUE(closed.is_valid()) << closed.describe();
    EXPECT_EQ(closed.euler_characteristic, 2);
    // A cube that cuts the sphere's corners off: at most the cube between the outer nodes, plus the cap's
    // 0.02 spacings all around.
    const double side = 2.0 * 0.006 + 2.0 * 0.02 * 0.0005;
    EXPECT_LE(closed.volume, side * side * side * (1.0 + 1e-6));
    EXPECT_GT(closed.volume, 0.9 * side * side * side);

    const MeshReport open = check(isosurface(grid, 0.0f, Border::open));
    EXPECT_GT(open.open_edges, 0u);
    EXPECT_EQ(open.nonmanifold_edges + open.misoriented_edges + open.pinched_vertices, 0u);
}

// Two solids that touch in a node, and values that equal the level: still manifold.
TEST(IsosurfaceBorder, FieldEqualToTheLevelStaysManifold) {
    DistanceGrid grid;
    grid.size = {6, 6, 6};
    grid.spacing = 1.0f;
    std::uint32_t state = 7;
    for (int i = 0; i < 216; ++i) {
        state = state * 1664525u + 1013904223u;
        grid.value.push_back(static_cast<float>(static_cast<int>(state >> 30) - 1));  // -1, 0, 1 or 2
    }
    const MeshReport report = check(isosurface(grid, 0.0f));
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_GT(report.components, 1u);
}

TEST(Normals, AreRadialOnAnOctahedron) {
    const TriangleMesh mesh = test::octahedron(0.02f);
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    for (std::size_t v = 0; v < normals.size(); ++v) {
        EXPECT_LT((normals[v] - mesh.vertices[v].normalized()).norm(), 1e-6f);
    }
}

// Noise of a third of a spacing on a sphere. Taubin's filter has gain (1 - lambda k)(1 - mu k) per iteration;
// at the highest frequencies (k about 1.5 on a triangle mesh) that is below 0.45. Ten iterations thus remove
// most of the roughness, while the sphere itself (k near 0) keeps its volume.
TEST(Smooth, RemovesNoiseAndKeepsVolume) {
    const test::Sphere sphere;
    const float spacing = 0.0005f;
    TriangleMesh mesh = isosurface(test::sample_grid(sphere, sphere.half_extent, spacing), 0.0f);
    std::uint32_t state = 99;
    for (Vec3f& v : mesh.vertices) {
        state = state * 1664525u + 1013904223u;
        const float noise = static_cast<float>(state >> 8) * 0x1p-24f - 0.5f;
        v += 0.66f * noise * spacing * (v - sphere.centre).normalized();
    }
    const auto roughness = [&] {
        double sum = 0.0;
        for (const Vec3f& v : mesh.vertices) {
            sum += std::pow(double{sphere(v)}, 2);
        }
        return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
    };
    const double before = roughness();
    smooth(mesh, 10);
    EXPECT_LT(roughness(), 0.4 * before);
    EXPECT_NEAR(check(mesh).volume, sphere.volume(), 0.01 * sphere.volume());
}

}  // namespace
}  // namespace eti
