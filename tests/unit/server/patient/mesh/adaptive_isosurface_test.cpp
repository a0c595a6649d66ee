// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/adaptive_isosurface.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "common/mesh/check.hpp"
#include "tests/unit/common/mesh/shapes.hpp"

namespace eti {
namespace {

template <class Shape>
AdaptiveField field_of(const Shape& shape, float half_extent) {
    AdaptiveField field;
    field.low = Vec3f::Constant(-half_extent);
    field.high = Vec3f::Constant(half_extent);
    field.value = [&shape](std::span<const Vec3f> points, std::span<float> values) {
        std::ranges::transform(points, values.begin(), shape);
    };
    field.edge = [](const Vec3f&) { return 0.5e-3f; };
    return field;
}

template <typename Shape>
class AdaptiveIsosurface : public testing::Test {};
using Shapes = testing::Types<test::Sphere, test::Torus>;
TYPED_TEST_SUITE(AdaptiveIsosurface, Shapes);

// As for the regular grid (isosurface_test.cpp), with cells of up to 1.25 of the wanted edge: see Bisector.
TYPED_TEST(AdaptiveIsosurface, HasTheShapesVolumeAreaAndTopology) {
    const TypeParam shape;
    const TriangleMesh mesh = adaptive_isosurface(field_of(shape, shape.half_extent));
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, TypeParam::euler_characteristic);
    const double curvature = 1.0 / 0.003;
    const double spacing = 1.25 * 0.5e-3;
    const double depth = 0.75 * curvature * spacing * spacing + 0.035 * spacing;
    EXPECT_NEAR(report.volume, shape.volume(), shape.area() * depth);
    EXPECT_NEAR(report.area, shape.area(), shape.area() * 2.0 * curvature * depth);
}

// Fine on one side, coarse on the other: no hanging nodes between them.
TEST(AdaptiveIsosurface, RespectsLocalEdgeLength) {
    const test::Sphere sphere;
    AdaptiveField field = field_of(sphere, test::Sphere::half_extent);
    const Vec3f place = sphere.centre + Vec3f(0.0f, 0.0f, sphere.radius);
    field.edge = [&](const Vec3f& p) { return 0.2e-3f + 0.3f * std::max((p - place).norm() - 1e-3f, 0.0f); };
    const TriangleMesh mesh = adaptive_isosurface(field);
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.euler_characteristic, 2);
    // Diagonals of a cube are its longest edges; cubes are at most 1.25 of the requested size.
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
            ASSERT_LT((a - b).norm(), std::sqrt(3.0f) * 1.25f * field.edge(0.5f * (a + b)) + 1e-4f);
        }
    }
    // With the finest cells everywhere: 4 pi r^2 / (0.2 mm)^2 cubes of some triangles each.
    EXPECT_LT(report.triangles, 31400u / 4);
    EXPECT_GT(report.triangles, 500u);
}

// A field that is not a distance, with a jump in edge length: still closed.
TEST(AdaptiveIsosurface, IsClosedForAnyField) {
    const auto noise = [](const Vec3f& p) {
        const auto mix = [](float x) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(1e7f * x));
        };
        Random random(mix(p.x()) * 0x8da6b343u ^ mix(p.y()) * 0xd8163841u ^ mix(p.z()) * 0xcb1ab31fu);
        return 1e-3f * (random.uniform() - 0.5f);
    };
    AdaptiveField field = field_of(noise, 8e-3f);
    field.edge = [](const Vec3f& p) { return p.x() > 1e-3f ? 0.5e-3f : 3e-3f; };
    const MeshReport report = check(adaptive_isosurface(field));
    EXPECT_TRUE(report.is_valid()) << report.describe();
}

TEST(AdaptiveIsosurface, SolidThatReachesTheBorderIsCapped) {
    const test::Sphere sphere;
    AdaptiveField field = field_of(sphere, 0.006f);  // smaller than the sphere
    const MeshReport report = check(adaptive_isosurface(field));
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.euler_characteristic, 2);
}

}  // namespace
}  // namespace eti
