// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/simplify.hpp"

#include <gtest/gtest.h>

#include "common/mesh/check.hpp"
#include "common/mesh/isosurface.hpp"
#include "tests/unit/common/mesh/shapes.hpp"

namespace eti {
namespace {

template <typename Shape>
class Simplify : public testing::Test {};
using Shapes = testing::Types<test::Sphere, test::Torus>;
TYPED_TEST_SUITE(Simplify, Shapes);

// n equilateral triangles of area A / n on a surface of principal radii r: circumradius c with c^2 = 4 A / (3
// sqrt(3) n), sagitta c^2 / 2r. Vertices follow the planes of the original, hence lie outside the surface by
// at most one such sagitta, while chords lie inside by one. Triangles stretched along the lesser curvature
// reach further, hence the factor two. Volume error: area times that depth.
TYPED_TEST(Simplify, KeepsManifoldTopologyAndVolume) {
    const TypeParam shape;
    const TriangleMesh fine = isosurface(test::sample_grid(shape, shape.half_extent, 0.0004f), 0.0f);
    const double radius = std::is_same_v<TypeParam, test::Torus> ? 0.003 : 0.010;
    for (const std::size_t budget : {4000u, 1000u, 400u}) {
        const TriangleMesh coarse = simplify(fine, {.triangles = budget});
        const MeshReport report = check(coarse);
        EXPECT_TRUE(report.is_valid()) << report.describe();
        EXPECT_EQ(report.euler_characteristic, TypeParam::euler_characteristic);
        EXPECT_LE(report.triangles, budget);
        EXPECT_GE(report.triangles, budget - 2);
        const double circumradius_squared =
            4.0 * shape.area() / (3.0 * std::sqrt(3.0) * static_cast<double>(budget));
        const double sagitta = circumradius_squared / (2.0 * radius);
        EXPECT_NEAR(report.volume, shape.volume(), 2.0 * shape.area() * sagitta) << report.describe();
    }
}

TEST(SimplifyPlanes, CubeKeepsItsCornersExactly) {
    // Nodes lie half a spacing off the faces: cells cut flat faces, and only edges and corners are rounded,
    // by at most half a spacing. Planes then cost nothing and the budget goes to the edges.
    const auto cube = [](const Vec3f& p) { return p.cwiseAbs().maxCoeff() - 0.01025f; };
    const TriangleMesh fine = isosurface(test::sample_grid(cube, 0.0125f, 0.0005f), 0.0f);
    const TriangleMesh coarse = simplify(fine, {.triangles = 300});
    const MeshReport report = check(coarse);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    // Bevels of the field's sampling cut the 12 edges (0.0205 m long) by at most half a square spacing.
    const double bevels = 12 * 0.0205 * 0.5 * 0.0005 * 0.0005;
    EXPECT_NEAR(report.volume, std::pow(0.0205, 3), bevels);
}

TEST(SimplifyWeights, ImportanceMakesTrianglesSmaller) {
    const test::Sphere sphere;
    const TriangleMesh fine = isosurface(test::sample_grid(sphere, sphere.half_extent, 0.0004f), 0.0f);
    std::vector<float> importance;
    for (const Vec3f& v : fine.vertices) {
        importance.push_back(v.x() > sphere.centre.x() ? 100.0f : 1.0f);
    }
    const TriangleMesh coarse = simplify(fine, {.triangles = 1000, .importance = importance});
    std::size_t important = 0;
    for (const Triangle& t : coarse.triangles) {
        const float x = coarse.vertices[t[0]].x() + coarse.vertices[t[1]].x() + coarse.vertices[t[2]].x();
        important += x > 3.0f * sphere.centre.x() ? 1 : 0;
    }
    // A triangle of area a costs about w a (a / r)^2 (area times squared sagitta), so equal costs mean
    // areas in the ratio 100^(1/3) = 4.6. Greedy order and the seam leave room; without weights: 0.5.
    const double share = static_cast<double>(important) / static_cast<double>(coarse.triangles.size());
    EXPECT_GT(share, 0.72);
    EXPECT_LT(share, 0.90);
    EXPECT_TRUE(check(coarse).is_valid());
}

TEST(SimplifyLimits, MaxErrorStopsBeforeTheBudget) {
    const test::Sphere sphere;
    const TriangleMesh fine = isosurface(test::sample_grid(sphere, sphere.half_extent, 0.0004f), 0.0f);
    const TriangleMesh coarse = simplify(fine, {.triangles = 4, .max_error = 2e-5f});
    EXPECT_GT(coarse.triangles.size(), 100u);
    EXPECT_LT(coarse.triangles.size(), fine.triangles.size() / 4);
    // The mean over the planes is limited, so a single vertex may stray further; four times covers it.
    for (const Vec3f& v : coarse.vertices) {
        EXPECT_LT(std::abs(sphere(v)), 8e-5f);
    }
}

TEST(SimplifyLimits, OpenBorderStays) {
    const test::Sphere sphere;
    const TriangleMesh fine = isosurface(test::sample_grid(sphere, 0.009f, 0.0005f), 0.0f, Border::open);
    const MeshReport before = check(fine);
    ASSERT_GT(before.open_edges, 0u);
    const MeshReport after = check(simplify(fine, {.triangles = before.triangles / 2}));
    EXPECT_EQ(after.open_edges, before.open_edges);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
    EXPECT_EQ(after.nonmanifold_edges, 0u);
    EXPECT_EQ(after.components, before.components);
}

// A tetrahedron has no edge that can be collapsed.
TEST(SimplifyLimits, ClosedMeshKeepsATetrahedron) {
    const TriangleMesh mesh = simplify(test::octahedron(0.01f), {.triangles = 0});
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.euler_characteristic, 2);
    EXPECT_GE(report.triangles, 4u);
}

}  // namespace
}  // namespace eti
