// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/rigid/capsule_contacts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/math/random.hpp"
#include "shell_shapes.hpp"

namespace eti::rigid {
namespace {

using test::box_mesh;
using test::floor_mesh;

std::vector<CapsuleContact> contacts_of(const Capsule& capsule, const TriangleMesh& mesh, float margin) {
    const MeshTopology topology(mesh.triangles, mesh.vertices.size());
    const MeshView view{mesh.vertices, mesh.triangles, topology};
    std::vector<CapsuleContact> contacts;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        append_contacts(capsule, 0, t, view, margin, contacts);
    }
    return contacts;
}

float distance_to_box(const Vec3f& p, float half) {
    return (p.cwiseAbs().array() - half).max(0.0f).matrix().norm();
}

// The distance to a convex body is convex along a line, so a ternary search finds its minimum.
float segment_to_box(const Vec3f& a, const Vec3f& b, float half) {
    float low = 0.0f;
    float high = 1.0f;
    for (int i = 0; i < 60; ++i) {
        const float third = (high - low) / 3.0f;
        const float s = low + third;
        const float t = high - third;
        (distance_to_box(a + s * (b - a), half) < distance_to_box(a + t * (b - a), half) ? high : low) =
            distance_to_box(a + s * (b - a), half) < distance_to_box(a + t * (b - a), half) ? t : s;
    }
    return distance_to_box(a + 0.5f * (low + high) * (b - a), half);
}

TEST(CapsuleContacts, NearestContactMatchesTheConvexBodyDistance) {
    const TriangleMesh mesh = box_mesh(Vec3f::Constant(-1), Vec3f::Constant(1), 4);
    Random random(7);
    int tested = 0;
    for (int i = 0; i < 4000; ++i) {
        const auto coordinate = [&] { return 4.0f * random.uniform() - 2.0f; };
        const Vec3f a(coordinate(), coordinate(), coordinate());
        const Vec3f b(coordinate(), coordinate(), coordinate());
        const float expected = segment_to_box(a, b, 1.0f);
        if (expected < 0.05f) {
            continue;
        }
        ++tested;
        float nearest = 1e9f;
        for (const CapsuleContact& contact : contacts_of({a, b, 0.1f}, mesh, 3.0f)) {
            nearest = std::min(nearest, contact.distance + 0.1f);
        }
        // Both sides are float closest-point formulas on coordinates of size 2: a few tens of ulps (1.2e-7
        // each) grow by the conditioning of near-parallel segments, bounded by 1e-6 in closest_on_segments.
        // Its root is 1e-3, times the tilt that the threshold still allows (1e-3), over unit lengths.
        EXPECT_NEAR(nearest, expected, 2e-5f) << a.transpose() << " / " << b.transpose();
    }
    EXPECT_GT(tested, 1000);
}

TEST(CapsuleContacts, FlatGridGivesOnlyTheFaceNormal) {
    const TriangleMesh mesh = floor_mesh(2.0f, 20);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const Vec3f a(random.uniform() - 0.5f, 0.1f, random.uniform() - 0.5f);
        const Vec3f b(random.uniform() - 0.5f, 0.1f, random.uniform() - 0.5f);
        const auto contacts = contacts_of({a, b, 0.08f}, mesh, 0.3f);
        ASSERT_GE(contacts.size(), 2u);
        for (const CapsuleContact& contact : contacts) {
            EXPECT_GT(contact.normal.y(), 0.999999f);
            EXPECT_NEAR(contact.distance, 0.02f, 1e-6f);
        }
    }
}

TEST(CapsuleContacts, TrianglesActOnTheirFrontOnly) {
    const TriangleMesh mesh = floor_mesh(2.0f, 4);
    EXPECT_FALSE(contacts_of({{-0.2f, 0.05f, 0}, {0.2f, 0.05f, 0}, 0.1f}, mesh, 0.0f).empty());
    EXPECT_TRUE(contacts_of({{-0.2f, -0.05f, 0}, {0.2f, -0.05f, 0}, 0.1f}, mesh, 0.0f).empty());
}

TEST(CapsuleContacts, RidgeUnderTheMiddleTouchesOnce) {
    TriangleMesh mesh;
    mesh.vertices = {{-1, -0.2f, -1}, {0, 0, -1}, {1, -0.2f, -1}, {-1, -0.2f, 1}, {0, 0, 1}, {1, -0.2f, 1}};
    mesh.triangles = {{0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}};
    const auto contacts = contacts_of({{-0.5f, 0.1f, 0.1f}, {0.5f, 0.1f, 0.1f}, 0.11f}, mesh, 0.0f);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR((contacts[0].point - Vec3f(0, 0, 0.1f)).norm(), 0.0f, 1e-6f);
    EXPECT_NEAR(contacts[0].distance, -0.01f, 1e-6f);
    EXPECT_GT(contacts[0].normal.y(), 0.999999f);
}

TEST(CapsuleContacts, TopologyPairsEveryEdgeOfAClosedMesh) {
    const TriangleMesh mesh = box_mesh(Vec3f::Constant(-1), Vec3f::Constant(1), 3);
    const MeshTopology topology(mesh.triangles, mesh.vertices.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int e = 0; e < 3; ++e) {
            ASSERT_NE(topology.neighbour(t, e), MeshTopology::none);
            const Triangle& other = mesh.triangles[topology.neighbour(t, e)];
            EXPECT_NE(std::find(other.begin(), other.end(), topology.across(t, e)), other.end());
        }
    }
    std::size_t incidences = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        incidences += topology.incident_triangles(v).size();
    }
    EXPECT_EQ(incidences, 3 * mesh.triangles.size());
}

}  // namespace
}  // namespace eti::rigid
