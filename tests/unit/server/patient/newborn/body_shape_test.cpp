// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"
#include "common/mesh/check.hpp"
#include "common/mesh/closest_point.hpp"
#include "server/patient/newborn/body/body_shape.hpp"

namespace eti::patient {
namespace {

// Model coordinates: x left, y anterior, z superior; millimetres of a 3.5 kg newborn.
class BodyShapeTest : public testing::TestWithParam<float> {
  protected:
    void SetUp() override {
        if (!BodyShape::is_available()) {
            GTEST_SKIP() << "built without a body's data";
        }
    }
    const BodyShape body_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Weeks, BodyShapeTest, testing::Values(24.0f, 28.0f, 40.0f));

TEST_P(BodyShapeTest, SurfaceIsClosedAndManifold) {
    const MeshReport report = check(body_.surface());
    EXPECT_EQ(report.open_edges + report.nonmanifold_edges + report.misoriented_edges, 0u)
        << report.describe();
    EXPECT_EQ(report.euler_characteristic, 2) << "a sphere: mouth and eyes are closed";
    // 3.5 kg at the density of water; the body is drawn up to 5 % larger in length, so that it covers the
    // generator's bones.
    EXPECT_GT(report.volume, 3.3e6);
    EXPECT_LT(report.volume, 1.16 * 3.5e6);
}

float exact_distance(const TriangleMesh& mesh, const Vec3f& point) {
    float nearest = 1e9f;
    for (const Triangle& t : mesh.triangles) {
        const Vec3f at =
            closest_on_triangle(point, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]).point;
        nearest = std::min(nearest, (point - at).norm());
    }
    return nearest;
}

// Grids of 1 and 2 mm: a spline through their nodes rounds edges off by a fraction of a spacing.
TEST_P(BodyShapeTest, DistanceAgreesWithNearestTriangle) {
    const TriangleMesh& mesh = body_.surface();
    Random random(3);
    const auto any = [&](std::size_t count) {
        return std::min(static_cast<std::size_t>(random.uniform() * static_cast<float>(count)), count - 1);
    };
    for (int i = 0; i < 100; ++i) {
        const Triangle& t = mesh.triangles[any(mesh.triangles.size())];
        const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const Vec3f normal = (b - a).cross(c - a).normalized();
        const Vec3f point = (a + b + c) / 3.0f + (2.0f * random.uniform() - 1.0f) * 2.0f * normal;
        const Vec3f off_eye(std::fabs(point.x()) - 18.0f, point.y() - 28.0f, point.z() - 29.0f);
        if (off_eye.norm() < 18.0f) {
            continue;  // the data's sockets are hollow, the shape's are filled
        }
        EXPECT_NEAR(std::fabs(body_.distance(point)), exact_distance(mesh, point), 0.8f) << point.transpose();
    }
    EXPECT_LT(body_.distance({0, 0, -150}), -20.0f);
    EXPECT_GT(body_.distance({0, 120, 0}), 30.0f);
}

// Skin weights take what lies above the neck for the head.
TEST_P(BodyShapeTest, HandsStayBelowNeck) {
    for (const Vec3f& p : body_.surface().vertices) {
        if (std::fabs(p.x()) > 75.0f) {
            EXPECT_LT(p.z(), -42.0f) << p.transpose();
        }
    }
}

TEST_P(BodyShapeTest, DetailIsFineAtFaceAndFingers) {
    const auto [low, high] = body_.bounds();
    const auto finest_near = [&](const Vec3f& from, const Vec3f& to) {
        float finest = 100.0f;
        for (const Vec3f& p : body_.surface().vertices) {
            if ((p.array() > from.array()).all() && (p.array() < to.array()).all()) {
                finest = std::min(finest, body_.detail(p));
            }
        }
        return finest;
    };
    EXPECT_LT(finest_near({10, 30, 15}, {30, 60, 32}), 0.8f) << "lids";
    EXPECT_LT(finest_near({high.x() - 30.0f, low.y(), -200}, high), 1.2f) << "fingers";
    EXPECT_GT(body_.detail({0, 90, -180}), 2.0f) << "belly";
}

}  // namespace
}  // namespace eti::patient
