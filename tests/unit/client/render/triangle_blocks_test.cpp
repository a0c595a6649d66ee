// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/triangle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/render/views/camera.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

// Every vertex is skinned to two frames, with weights that shift from one to the other along z.
std::vector<SkinWeights> skin_of(const TriangleMesh& mesh) {
    std::vector<SkinWeights> skin(mesh.vertices.size());
    for (std::size_t v = 0; v < skin.size(); ++v) {
        const float share = std::clamp(0.5f + 10.0f * mesh.vertices[v].z(), 0.0f, 1.0f);
        skin[v].frame = {0, 1};
        skin[v].weight = {share, 1.0f - share};
    }
    return skin;
}

const std::vector<FrameMap> at_rest(2);

std::vector<Triangle> triangles_of(const render::TriangleBlocks& blocks,
                                   std::span<const render::TriangleBlocks::Range> ranges) {
    std::vector<Triangle> out;
    for (const auto& range : ranges) {
        const auto part = blocks.triangles().subspan(range.first, range.count);
        out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
    std::vector<Triangle> copy(triangles.begin(), triangles.end());
    std::sort(copy.begin(), copy.end());
    return copy;
}

const Eigen::Vector4f everywhere(0.0f, 0.0f, 0.0f, 1.0f);

TEST(TriangleBlocks, DistantViewContainsEachTriangleOnce) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin_of(mesh));
    blocks.update(at_rest);
    render::Camera camera;
    camera.eye = Vec3f(0.5f, -0.5f, 0.5f);
    camera.target = Vec3f(0.0f, 0.04f, 0.0f);
    camera.vertical_fov = 1.0f;
    const auto all =
        triangles_of(blocks, blocks.visible(camera.projection(1.0f) * camera.view(), camera.eye, everywhere));
    EXPECT_EQ(sorted(all), sorted(mesh.triangles));
}

// Reference: every vertex projected individually. A triangle with a corner in the picture must be included.
TEST(TriangleBlocks, CullingKeepsVisibleTriangles) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin_of(mesh));
    blocks.update(at_rest);
    const Eigen::Vector4f right_half(-1.0f, 0.0f, 0.0f, 0.0f);
    for (const float field : {0.05f, 0.2f, 0.6f}) {
        render::Camera camera;
        camera.eye = Vec3f(0.1f, -0.25f, 0.2f);
        camera.target = Vec3f(0.0f, 0.03f, 0.0f);
        camera.vertical_fov = field;
        const Eigen::Matrix4f matrix = camera.projection(4.0f / 3.0f) * camera.view();
        const auto drawn = sorted(triangles_of(blocks, blocks.visible(matrix, camera.eye, right_half)));
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

// The half whose second frame has moved enters a picture that holds nothing at rest.
TEST(TriangleBlocks, BoundsFollowSkinningFrames) {
    const TriangleMesh mesh = synthetic::body_mesh();
    const std::vector<SkinWeights> skin = skin_of(mesh);
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin);
    std::vector<FrameMap> frames(2);
    frames[1].linear = Eigen::AngleAxisf(0.5f, Vec3f::UnitX()).toRotationMatrix();
    frames[1].offset = Vec3f(0.4f, 0.0f, 0.0f);
    render::Camera camera;
    camera.eye = Vec3f(0.35f, -0.5f, 0.0f);
    camera.target = Vec3f(0.35f, 0.04f, 0.0f);
    camera.vertical_fov = 0.3f;
    const Eigen::Matrix4f matrix = camera.projection(1.0f) * camera.view();
    blocks.update(at_rest);
    EXPECT_TRUE(blocks.visible(matrix, camera.eye, everywhere).empty());
    blocks.update(frames);
    const auto drawn = sorted(triangles_of(blocks, blocks.visible(matrix, camera.eye, everywhere)));
    std::size_t needed = 0;
    for (const Triangle& triangle : mesh.triangles) {
        if (std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) {
                const Eigen::Vector4f clip =
                    matrix * skin_point(mesh.vertices[v], skin[v], frames).homogeneous();
                return clip.head<3>().cwiseAbs().maxCoeff() < clip.w();
            })) {
            ++needed;
            EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), triangle));
        }
    }
    EXPECT_GT(needed, 100u);
}

// Surfaces that the caller declares displaced enter a picture that holds none of them at rest.
TEST(TriangleBlocks, BoundsIncludeDisplacementMargin) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin_of(mesh));
    blocks.update(at_rest);
    render::Camera camera;
    camera.eye = Vec3f(0.35f, -0.5f, 0.0f);
    camera.target = Vec3f(0.35f, 0.04f, 0.0f);
    camera.vertical_fov = 0.3f;
    const Eigen::Matrix4f matrix = camera.projection(1.0f) * camera.view();
    const auto far = [](const Vec3f& centre, float) { return centre.z() > 0.0f ? 0.3f : 0.0f; };
    EXPECT_TRUE(blocks.visible(matrix, camera.eye, everywhere).empty());
    const auto drawn = triangles_of(blocks, blocks.visible(matrix, camera.eye, everywhere, far));
    EXPECT_GT(drawn.size(), 100u);
    EXPECT_LT(drawn.size(), mesh.triangles.size() * 3 / 4) << "what lies lower stays out";
    // The same for moved frames.
    blocks.update(at_rest, far);
    EXPECT_EQ(sorted(triangles_of(blocks, blocks.visible(matrix, camera.eye, everywhere))), sorted(drawn));
    EXPECT_TRUE(
        blocks.visible(matrix, camera.eye, everywhere, {}, [](const Vec3f&, float, float) { return false; })
            .empty());
}

// Reference: each triangle individually.
TEST(TriangleBlocks, PlaneQueryContainsAllCutTriangles) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin_of(mesh));
    blocks.update(at_rest);
    for (const Eigen::Vector4f& plane :
         {Eigen::Vector4f(-1.0f, 0.0f, 0.0f, 0.0f), Eigen::Vector4f(0.3f, 1.0f, 2.0f, 0.01f)}) {
        const auto found = blocks.cut_candidates(plane);
        const auto drawn = sorted(triangles_of(blocks, found.ranges));
        std::size_t cut = 0;
        for (const Triangle& triangle : mesh.triangles) {
            int beyond = 0;
            for (const std::uint32_t v : triangle) {
                beyond += plane.head<3>().dot(mesh.vertices[v]) + plane.w() < 0.0f ? 1 : 0;
            }
            if (beyond == 1 || beyond == 2) {
                ++cut;
                EXPECT_TRUE(std::binary_search(drawn.begin(), drawn.end(), triangle));
                EXPECT_TRUE(found.box.contains(mesh.vertices[triangle[0]]));
            }
        }
        EXPECT_GT(cut, 50u);
        EXPECT_LT(drawn.size(), mesh.triangles.size() / 2);
        EXPECT_TRUE(found.box.contains(found.middle));
    }
    EXPECT_TRUE(blocks.cut_candidates({0.0f, 0.0f, 1.0f, 10.0f}).ranges.empty());
}

TEST(TriangleBlocks, AreSortedFrontToBack) {
    const TriangleMesh mesh = synthetic::body_mesh();
    render::TriangleBlocks blocks(mesh.triangles, mesh.vertices, skin_of(mesh));
    blocks.update(at_rest);
    render::Camera camera;
    camera.eye = Vec3f(0.0f, -0.6f, 0.0f);
    camera.target = Vec3f(0.0f, 0.04f, 0.0f);
    camera.vertical_fov = 1.0f;
    const auto drawn =
        triangles_of(blocks, blocks.visible(camera.projection(1.0f) * camera.view(), camera.eye, everywhere));
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
