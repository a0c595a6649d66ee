// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/triangle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/render/camera.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

std::vector<view::LitVertex> lit(const TriangleMesh& mesh) {
    std::vector<view::LitVertex> vertices(mesh.vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].position = mesh.vertices[v];
    }
    return vertices;
}

std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
    std::vector<Triangle> copy(triangles.begin(), triangles.end());
    std::sort(copy.begin(), copy.end());
    return copy;
}

const Eigen::Vector4f everywhere(0.0f, 0.0f, 0.0f, 1.0f);

TEST(TriangleBlocks, SeeEverythingOnceFromAfar) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices);
    blocks.update(lit(mesh));
    render::Camera camera;
    camera.eye = Vec3f(0.5f, -0.5f, 0.5f);
    camera.target = Vec3f(0.0f, 0.04f, 0.0f);
    camera.vertical_field = 1.0f;
    const auto all = blocks.visible(camera.projection(1.0f) * camera.view(), camera.eye, everywhere);
    EXPECT_EQ(sorted(all), sorted(mesh.triangles));
}

// Reference: every vertex projected by itself. A triangle with a corner in the picture must be there.
TEST(TriangleBlocks, NeverLeaveOutWhatIsInThePicture) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices);
    blocks.update(lit(mesh));
    const Eigen::Vector4f right_half(-1.0f, 0.0f, 0.0f, 0.0f);
    for (const float field : {0.05f, 0.2f, 0.6f}) {
        render::Camera camera;
        camera.eye = Vec3f(0.1f, -0.25f, 0.2f);
        camera.target = Vec3f(0.0f, 0.03f, 0.0f);
        camera.vertical_field = field;
        const Eigen::Matrix4f matrix = camera.projection(4.0f / 3.0f) * camera.view();
        const auto drawn = sorted(blocks.visible(matrix, camera.eye, right_half));
        std::size_t needed = 0;
        for (const Triangle& triangle : mesh.triangles) {
            const bool seen = std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
                const Vec3f& p = mesh.vertices[v];
                const Eigen::Vector4f clip = matrix * p.homogeneous();
                return clip.w() > 0.0f && clip.head<3>().cwiseAbs().maxCoeff() < clip.w() && p.x() < 0.0f;
            });
            if (seen) {
                ++needed;
                EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), triangle));
            }
        }
        EXPECT_GT(needed, 0u);
        // Half of the body lies behind the plane; blocks across it are the only waste there.
        EXPECT_LT(drawn.size(), mesh.triangles.size() * 2 / 3);
    }
}

TEST(TriangleBlocks, ComeNearestFirst) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices);
    blocks.update(lit(mesh));
    render::Camera camera;
    camera.eye = Vec3f(0.0f, -0.6f, 0.0f);
    camera.target = Vec3f(0.0f, 0.04f, 0.0f);
    camera.vertical_field = 1.0f;
    const auto drawn = blocks.visible(camera.projection(1.0f) * camera.view(), camera.eye, everywhere);
    const auto distance = [&](const Triangle& t) { return (mesh.vertices[t[0]] - camera.eye).norm(); };
    const std::size_t tenth = drawn.size() / 10;
    double first = 0.0, last = 0.0;
    for (std::size_t i = 0; i < tenth; ++i) {
        first += distance(drawn[i]);
        last += distance(drawn[drawn.size() - 1 - i]);
    }
    // The head is 0.1 m deep from here.
    EXPECT_GT((last - first) / static_cast<double>(tenth), 0.05);
}

}  // namespace
}  // namespace eti
