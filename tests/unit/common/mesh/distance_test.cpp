// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/distance.hpp"

#include <gtest/gtest.h>

#include "common/mesh/closest_point.hpp"
#include "common/mesh/isosurface.hpp"
#include "tests/unit/common/mesh/shapes.hpp"

namespace eti {
namespace {

// A function that is linear in each coordinate is its own trilinear interpolant.
TEST(DistanceGridTest, TrilinearFunctionIsReproduced) {
    const auto f = [](const Vec3f& p) {
        return 0.3f + 2.0f * p.x() - p.y() + 0.5f * p.z() + 40.0f * p.x() * p.y() -
               25.0f * p.x() * p.y() * p.z();
    };
    const DistanceGrid grid = test::sample_grid(f, 0.02f, 0.004f);
    std::uint32_t state = 5;
    const auto next = [&state] {
        state = state * 1664525u + 1013904223u;
        return (static_cast<float>(state >> 8) * 0x1p-24f - 0.5f) * 0.039f;
    };
    for (int i = 0; i < 1000; ++i) {
        const Vec3f p(next(), next(), next());
        ASSERT_NEAR(grid.distance(p), f(p), 1e-6f);  // float32 of values near 0.3
        const Vec3f gradient(2.0f + 40.0f * p.y() - 25.0f * p.y() * p.z(),
                             -1.0f + 40.0f * p.x() - 25.0f * p.x() * p.z(), 0.5f - 25.0f * p.x() * p.y());
        const DistanceSample sample = grid.sample(p);
        ASSERT_EQ(sample.distance, grid.distance(p));
        // Differences of node values of 0.3 carry 3e-8 / 0.004 of rounding, over a gradient of 1 to 3.
        ASSERT_LT((sample.normal - gradient.normalized()).norm(), 5e-5f);
    }
}

TEST(DistanceGridTest, OutsideTakesTheNearestBorderValue) {
    const test::Sphere sphere;
    const DistanceGrid grid = test::sample_grid(sphere, 0.01f, 0.001f);
    const float edge = -grid.origin.x();
    EXPECT_EQ(grid.distance({1.0f, 0.002f, 0.003f}), grid.distance({edge, 0.002f, 0.003f}));
    EXPECT_EQ(grid.distance({-7.0f, 5.0f, -2.0f}), grid.value[grid.index(0, grid.size[1] - 1, 0)]);
    EXPECT_TRUE(std::isfinite(grid.distance({std::nanf(""), 0.0f, 1e30f})));
}

// Directions all about.
Vec3f direction_of(int i) {
    const float t = 0.1f * static_cast<float>(i);
    return Vec3f(std::cos(t), std::sin(1.7f * t), std::cos(0.3f * t + 1.0f)).normalized();
}

// Interpolating a distance with curvature k on cells of size h errs by at most k h^2 / 8 per axis of
// curvature, two of them here.
TEST(DistanceGridTest, SphereWithinInterpolationBound) {
    const test::Sphere sphere;
    const float h = 0.0005f;
    const DistanceGrid grid = test::sample_grid(sphere, sphere.half_extent, h);
    for (int i = 0; i < 500; ++i) {
        const Vec3f direction = direction_of(i);
        const Vec3f p = sphere.centre + 0.0098f * direction;
        const DistanceSample sample = grid.sample(p);
        ASSERT_NEAR(sample.distance, sphere(p), 2.0f * h * h / (8.0f * 0.0098f) + 1e-8f);
        // The gradient errs by about k h / 2 per axis.
        ASSERT_LT((sample.normal - direction).norm(), 2.0f * h / (2.0f * 0.0098f));
    }
}

// Gradient and second derivatives are those of the distance itself, by finite differences, and are continuous
// at the faces of cells, where the trilinear gradient jumps.
TEST(DistanceGridTest, SmoothDistanceMatchesItsDerivatives) {
    const test::Sphere sphere;
    const float h = 0.0005f;
    const DistanceGrid grid = test::sample_grid(sphere, sphere.half_extent, h);
    constexpr float way = 2e-5f;
    for (int i = 0; i < 500; ++i) {
        const Vec3f p = sphere.centre + 0.0098f * direction_of(i);
        const SplineDistance steady = grid.spline_sample(p);
        // Two axes of curvature k, each of which shifts the distance by k h^2 / 8.
        ASSERT_NEAR(steady.distance, sphere(p) + 2.0f * h * h / (8.0f * 0.0098f), 1e-7f);
        // Float32 of distances about 1e-3, over 2 way; a second derivative changes by its own size within a
        // cell.
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            const Vec3f to = way * Vec3f::Unit(axis);
            const SplineDistance ahead = grid.spline_sample(p + to);
            const SplineDistance behind = grid.spline_sample(p - to);
            ASSERT_NEAR(steady.gradient[axis], (ahead.distance - behind.distance) / (2.0f * way), 2e-4f);
            // The second derivative is 1 / 0.0098 m; a jump in the gradient would be h times that, 0.05.
            ASSERT_LT((ahead.gradient - behind.gradient).norm(), 2.0f * way * 1.5f / 0.0098f);
        }
    }
}

// The brute-force reference samples the triangle densely.
TEST(ClosestPoint, IsNoFartherThanAnySample) {
    const Vec3f a(0.0f, 0.0f, 0.0f), b(1.0f, 0.1f, 0.0f), c(0.3f, 0.8f, 0.2f);
    for (int i = 0; i < 400; ++i) {
        const float t = 0.37f * static_cast<float>(i);
        const Vec3f p(2.0f * std::cos(t), 2.0f * std::sin(1.3f * t), std::sin(0.7f * t));
        const float found = (p - closest_on_triangle(p, a, b, c).point).norm();
        float best = 1e9f;
        for (int u = 0; u <= 100; ++u) {
            for (int v = 0; u + v <= 100; ++v) {
                const Vec3f q =
                    a + 0.01f * static_cast<float>(u) * (b - a) + 0.01f * static_cast<float>(v) * (c - a);
                best = std::min(best, (p - q).norm());
            }
        }
        ASSERT_LE(found, best + 1e-6f);
        ASSERT_GE(found, best - 0.011f);  // a sample lies within 1 % of a side of the true point
    }
}

template <typename Shape>
class Redistance : public testing::Test {};
using Shapes = testing::Types<test::Sphere, test::Torus>;
TYPED_TEST_SUITE(Redistance, Shapes);

// The field is far from a distance: growth like s (1 + s / w)^3, gradient 1/3 to 4 over the band. Linear
// interpolation misplaces the zero by at most |f''| h^2 / 8 / |f'| per edge of length sqrt(3) h. With f'' /
// f' = 2 / w + curvature that is 3/8 h^2 (2 / w + k); chords add 3/8 k h^2, the clearance 0.035 h.
TYPED_TEST(Redistance, RecoversDistancesFromABentField) {
    const TypeParam shape;
    const float h = 0.0005f;
    const float width = 0.01f;
    const auto bent = [&](const Vec3f& p) {
        const float s = shape(p);
        return 0.4f * s * (1.0f + s / width);
    };
    // The factor 1 + s / width stays positive down to s = -0.01, the sphere's centre.
    const DistanceGrid field = test::sample_grid(bent, shape.half_extent, h);
    const float band = 0.0025f;
    const DistanceGrid grid = redistance(field, band);
    const float curvature = std::is_same_v<TypeParam, test::Torus> ? 1.0f / 0.003f : 1.0f / 0.010f;
    const float bound = 0.375f * h * h * (2.0f / width + 2.0f * curvature) + 0.035f * h;
    // Contact requires a tenth of a spacing where the airway's walls are smooth.
    EXPECT_LT(bound, 0.2f * h);
    float worst = 0.0f;
    double squares = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < grid.value.size(); ++i) {
        const auto n = static_cast<std::size_t>(grid.size[0]);
        const Vec3f p =
            grid.node(static_cast<int>(i % n), static_cast<int>(i / n % n), static_cast<int>(i / n / n));
        const float expected = std::clamp(shape(p), -band, band);
        const float error = std::abs(grid.value[i] - expected);
        ASSERT_LT(error, bound) << p.transpose();
        worst = std::max(worst, error);
        squares += double{error} * double{error};
        ++count;
    }
    EXPECT_LT(std::sqrt(squares / count), 0.1 * double{h});
}

// Distance to a mesh's own triangles needs no model of the surface: the reference is brute force over all
// triangles. Within a spacing, every candidate triangle is tested, so only float32 rounding of centimetre
// coordinates remains (1e-9 m, squared and summed: 1e-8 m). Farther away, candidates come from neighbouring
// nodes, which may miss the closest triangle. Next to the tube's centre line, where it jumps, the error is
// below a tenth of a spacing, the accuracy that contact requires.
TEST(MeshDistance, AgreesWithBruteForce) {
    const test::Torus torus;
    const TriangleMesh mesh = isosurface(test::sample_grid(torus, torus.half_extent, 0.001f), 0.0f);
    const float h = 0.0008f;
    const float band = 0.004f;
    const DistanceGrid grid = mesh_distance(mesh, Vec3f::Constant(-0.016f), h, {41, 41, 41}, band);
    for (int z = 0; z < 41; z += 2) {
        for (int y = 0; y < 41; y += 3) {
            for (int x = 0; x < 41; x += 3) {
                const Vec3f p = grid.node(x, y, z);
                float best = band;
                for (const Triangle& t : mesh.triangles) {
                    best = std::min(best, (p - closest_on_triangle(p, mesh.vertices[t[0]],
                                                                   mesh.vertices[t[1]], mesh.vertices[t[2]])
                                                   .point)
                                              .norm());
                }
                const float found = grid.value[grid.index(x, y, z)];
                ASSERT_NEAR(std::abs(found), best, best < h ? 1e-8f : 0.1f * h);
                if (std::abs(torus(p)) > 0.2f * 0.001f) {
                    ASSERT_EQ(found < 0.0f, torus(p) < 0.0f) << p.transpose();
                }
            }
        }
    }
}

// Rays along x that run exactly through vertices and edges of an octahedron.
TEST(MeshDistance, RaysThroughVerticesCountOnce) {
    const TriangleMesh mesh = test::octahedron(0.01f);
    const DistanceGrid grid = mesh_distance(mesh, Vec3f::Constant(-0.0125f), 0.0025f, {11, 11, 11}, 1.0f);
    for (int z = 0; z < 11; ++z) {
        for (int y = 0; y < 11; ++y) {
            for (int x = 0; x < 11; ++x) {
                const Vec3f p = grid.node(x, y, z);
                // |x| + |y| + |z| = s; distance to the nearest face plane inside.
                const float level = (p.cwiseAbs().sum() - 0.01f) / std::sqrt(3.0f);
                const float found = grid.value[grid.index(x, y, z)];
                if (level < -1e-5f) {
                    ASSERT_NEAR(found, level, 1e-6f);
                } else if (level > 1e-5f) {
                    ASSERT_GT(found, 0.0f);
                }
            }
        }
    }
}

}  // namespace
}  // namespace eti
