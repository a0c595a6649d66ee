// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/tube_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/mesh/check.hpp"
#include "common/model/tools/tube_end.hpp"

namespace eti {
namespace {

// A tube that curves towards anterior (-y) on its way down (-z), as in a patient.
std::vector<Vec3f> quarter_arc(float radius, int count) {
    std::vector<Vec3f> nodes;
    for (int i = 0; i < count; ++i) {
        const float angle = 1.0f * static_cast<float>(i) / static_cast<float>(count - 1);
        nodes.emplace_back(0.0f, radius * (1.0f - std::cos(angle)) - 0.0f, -radius * std::sin(angle));
    }
    return nodes;
}

TriangleMesh mesh_of(const view::TubeSweep& sweep) {
    TriangleMesh mesh;
    for (const view::TubeVertex& vertex : sweep.vertices()) {
        mesh.vertices.push_back(vertex.position);
    }
    mesh.triangles.assign(sweep.triangles().begin(), sweep.triangles().end());
    return mesh;
}

TEST(TubeSweep, IsClosedManifoldOfGenusOne) {
    view::TubeSweep sweep({});
    ASSERT_TRUE(sweep.update(quarter_arc(0.16f, 24)));
    const MeshReport report = check(mesh_of(sweep));
    EXPECT_EQ(report.open_edges, 0u) << report.describe();
    EXPECT_EQ(report.nonmanifold_edges, 0u) << report.describe();
    EXPECT_EQ(report.misoriented_edges, 0u) << report.describe();
    EXPECT_EQ(report.self_intersections, 0u) << report.describe();
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, 0) << "open at both ends: one handle";
    EXPECT_GT(report.volume, 0.0) << "oriented outwards";
}

TEST(TubeSweep, StraightTubeHasGivenRadiiAndLength) {
    const Tube model;
    view::TubeSweep sweep(model);
    ASSERT_TRUE(sweep.update(std::vector<Vec3f>{{0, 0, 0}, {0, 0, -0.08f}, {0, 0, -0.16f}}));
    float longest = 0.0f, widest = 0.0f, narrowest = 1.0f;
    for (const view::TubeVertex& vertex : sweep.vertices()) {
        if (vertex.from_tip < model.length - 0.002f) {
            const float radius = std::hypot(vertex.position.x(), vertex.position.y());
            widest = std::max(widest, radius);
            narrowest = std::min(narrowest, radius);
        }
        longest = std::max(longest, -vertex.position.z());
        EXPECT_NEAR(vertex.from_tip, 0.16f + vertex.position.z(), 1e-5f);
    }
    EXPECT_NEAR(widest, model.outer_radius(), 1e-6f);
    EXPECT_NEAR(narrowest, model.inner_radius(), 1e-6f);
    EXPECT_NEAR(longest, 0.16f, 1e-5f);
}

// Reference: the tube end used for sight rays.
TEST(TubeSweep, EndMatchesServerBevel) {
    const Tube model;
    view::TubeSweep sweep(model);
    const std::vector<Vec3f> nodes = quarter_arc(0.08f, 24);
    ASSERT_TRUE(sweep.update(nodes));
    const std::optional<TubeEnd> end = tube_end(nodes, model.outer_radius());
    ASSERT_TRUE(end);
    const auto past_the_plane = [&](const Vec3f& p) {  // [m]
        return ((p - end->tip).dot(end->bevel) - end->beyond) / end->bevel.norm();
    };
    // The last ring of the outer wall; the end is treated as straight where it bends by 0.06 mm.
    constexpr std::size_t last = std::size_t{view::TubeSweep::rings - 1} * view::TubeSweep::sides;
    for (std::size_t i = last; i < last + view::TubeSweep::sides; ++i) {
        EXPECT_NEAR(past_the_plane(sweep.vertices()[i].position), 0.0f, 0.15e-3f);
    }
}

TEST(TubeSweep, BevelFacesLeftIfConcaveSideIsAnterior) {
    const Tube model;
    view::TubeSweep sweep(model);
    // Leads down (-z) and bends to anterior (-y), so its left is the patient's left (+x).
    std::vector<Vec3f> nodes = quarter_arc(0.16f, 24);
    for (Vec3f& node : nodes) {
        node.y() = -node.y();
    }
    ASSERT_TRUE(sweep.update(nodes));
    const view::TubeVertex* first_left = nullptr;
    float left_end = 1.0f, right_end = 1.0f;
    for (const view::TubeVertex& vertex : sweep.vertices()) {
        if (vertex.position.x() > 0.95f * model.outer_radius() && vertex.from_tip < left_end) {
            left_end = vertex.from_tip;
            first_left = &vertex;
        }
        if (vertex.position.x() < -0.95f * model.outer_radius()) {
            right_end = std::min(right_end, vertex.from_tip);
        }
    }
    ASSERT_NE(first_left, nullptr);
    // A bevel of 45 deg sets the left wall back by the diameter.
    EXPECT_NEAR(left_end - right_end, 2.0f * model.outer_radius(), 0.1f * model.outer_radius());
    EXPECT_NEAR(first_left->around, 0.25f, 1.01f / view::TubeSweep::sides)
        << "the leftmost side or its neighbour";
}

TEST(TubeSweep, RejectsZeroLengthPath) {
    view::TubeSweep sweep({});
    EXPECT_FALSE(sweep.update({}));
    EXPECT_FALSE(sweep.update(std::vector<Vec3f>{{0, 0, 0}}));
    EXPECT_FALSE(sweep.update(std::vector<Vec3f>(5, Vec3f(0.1f, 0, 0))));
    EXPECT_EQ(sweep.revision(), 0u);
}

TEST(TubeSweep, StaysFiniteOnPathThatDoublesBack) {
    view::TubeSweep sweep({});
    ASSERT_TRUE(
        sweep.update(std::vector<Vec3f>{{0, 0, 0}, {0, 0, 0.05f}, {0, 0, 0}, {0, 0, 0.05f}, {0, 0, 0.05f}}));
    for (const view::TubeVertex& vertex : sweep.vertices()) {
        EXPECT_TRUE(vertex.position.allFinite() && vertex.normal.allFinite());
    }
}

}  // namespace
}  // namespace eti
