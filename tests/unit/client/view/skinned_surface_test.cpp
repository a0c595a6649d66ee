// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/skinned_surface.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "common/math/random.hpp"

namespace eti {
namespace {

bus::RestSurface one_triangle() {
    bus::RestSurface model;
    model.mesh.vertices = {{0.0f, 0.0f, 0.0f}, {0.02f, 0.0f, 0.0f}, {0.0f, 0.02f, 0.0f}};
    model.mesh.triangles = {{0, 1, 2}};
    model.triangle_tissue = {Tissue::soft};
    model.skin.resize(3);
    return model;
}

// By hand: frame 0 stays; frame 1, centred at (0.02, 0, 0), rotates by a quarter about z and rises by 0.01.
// Vertex 1 lies on its centre, vertex 2 half on either frame.
TEST(Skinning, MatchesPosesComputedByHand) {
    bus::RestSurface model = one_triangle();
    model.highest_frame = 1;
    model.skin[0] = {{0, 0, 0, 0}, {1.0f, 0, 0, 0}};
    model.skin[1] = {{1, 0, 0, 0}, {1.0f, 0, 0, 0}};
    model.skin[2] = {{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
    const Quatf quarter(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Vec3f::UnitZ()));
    const std::array<FrameMap, 2> maps{
        frame_map({Vec3f::Zero(), Quatf::Identity()}, Vec3f::Zero()),
        frame_map({Vec3f(0.02f, 0.0f, 0.01f), quarter}, Vec3f(0.02f, 0.0f, 0.0f))};
    view::SkinnedSurface surface(std::move(model));
    ASSERT_TRUE(surface.update(maps, std::array<std::uint8_t, 2>{0, 1}));
    const auto at = [&](std::size_t v) { return surface.vertices()[v].position; };
    // Single precision at 0.02 m: 2 ulp are 4e-9 m.
    EXPECT_LT((at(0) - Vec3f(0, 0, 0)).norm(), 1e-8f);
    EXPECT_LT((at(1) - Vec3f(0.02f, 0, 0.01f)).norm(), 1e-8f);
    // (0, 0.02, 0) - centre = (-0.02, 0.02, 0), turned (-0.02, -0.02, 0), moved (0, -0.02, 0.01).
    EXPECT_LT((at(2) - 0.5f * (Vec3f(0, 0.02f, 0) + Vec3f(0, -0.02f, 0.01f))).norm(), 1e-8f);
    EXPECT_FALSE(surface.update(maps, std::array<std::uint8_t, 2>{0, 0}));
}

TEST(Skinning, AgreesWithTheSharedDefinition) {
    Random random(7);
    bus::RestSurface model = one_triangle();
    model.highest_frame = 3;
    std::array<Vec3f, 4> centres;
    std::array<FramePose, 4> poses;
    std::array<FrameMap, 4> maps;
    const auto point = [&]() -> Vec3f {
        return Vec3f(random.normal(), random.normal(), random.normal()) * 0.05f;
    };
    for (std::size_t f = 0; f < 4; ++f) {
        centres[f] = point();
        poses[f] = {point(), quaternion_from(20.0f * point())};
        maps[f] = frame_map(poses[f], centres[f]);
    }
    for (SkinWeights& skin : model.skin) {
        skin = {{0, 1, 2, 3}, {0.4f, 0.3f, 0.2f, 0.1f}};
    }
    view::SkinnedSurface surface(model);
    ASSERT_TRUE(surface.update(maps, std::array<std::uint8_t, 4>{1, 1, 1, 1}));
    for (std::size_t v = 0; v < 3; ++v) {
        const Vec3f expected = skin_point(model.mesh.vertices[v], model.skin[v], centres, poses);
        // Values near 0.2 m, some ten roundings of 1.5e-8 each.
        EXPECT_LT((surface.vertices()[v].position - expected).norm(), 2e-7f);
    }
}

// A strip of triangles along which the weight shifts from frame to frame.
TEST(Skinning, PartialUpdateIsBitIdenticalToFullUpdate) {
    constexpr std::uint32_t columns = 60, rows = 4, frame_count = 6;
    Random random(11);
    bus::RestSurface model;
    for (std::uint32_t column = 0; column < columns; ++column) {
        for (std::uint32_t row = 0; row < rows; ++row) {
            model.mesh.vertices.emplace_back(1e-3f * static_cast<float>(column),
                                             1e-3f * static_cast<float>(row),
                                             1e-3f * static_cast<float>(random.normal()));
            const float place = static_cast<float>(column) * (frame_count - 1) / columns;
            const auto left = static_cast<std::uint16_t>(place);
            const float share = place - static_cast<float>(left);
            model.skin.push_back(
                {{left, static_cast<std::uint16_t>(left + 1), 0, 0}, {1.0f - share, share, 0, 0}});
            if (column > 0 && row > 0) {
                const std::uint32_t here = column * rows + row;
                model.mesh.triangles.push_back({here, here - rows, here - 1});
                model.mesh.triangles.push_back({here - 1, here - rows, here - rows - 1});
            }
        }
    }
    model.highest_frame = frame_count - 1;
    view::SkinnedSurface surface(model);
    std::array<FrameMap, frame_count> maps{};
    std::array<std::uint8_t, frame_count> all;
    all.fill(1);
    ASSERT_TRUE(surface.update(maps, all));
    for (std::size_t f = 0; f < frame_count; ++f) {
        maps[f] =
            frame_map({1e-3f * Vec3f(random.normal(), random.normal(), random.normal()), Quatf::Identity()},
                      Vec3f::Zero());
        std::array<std::uint8_t, frame_count> moved{};
        moved[f] = 1;
        const std::uint64_t before = surface.revision();
        ASSERT_TRUE(surface.update(maps, moved));
        EXPECT_NE(surface.revision(), before);
        view::SkinnedSurface whole(model);
        ASSERT_TRUE(whole.update(maps, all));
        ASSERT_EQ(
            std::memcmp(surface.vertices().data(), whole.vertices().data(), surface.vertices().size_bytes()),
            0)
            << "frame " << f;
    }
}

TEST(Normals, OfASphereAreRadial) {
    constexpr std::uint32_t rings = 24, sides = 48;
    std::vector<view::LitVertex> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        for (std::uint32_t side = 0; side < sides; ++side) {
            const float polar = std::numbers::pi_v<float> * (static_cast<float>(ring) + 0.5f) / rings;
            const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / sides;
            vertices.push_back({0.02f * Vec3f(std::sin(polar) * std::cos(turn),
                                              std::sin(polar) * std::sin(turn), std::cos(polar)),
                                Vec3f::Zero()});
            const std::uint32_t next = ring * sides + (side + 1) % sides, here = ring * sides + side;
            if (ring + 1 < rings) {
                triangles.push_back({here, here + sides, next});
                triangles.push_back({next, here + sides, next + sides});
            }
        }
    }
    view::recompute_normals(triangles, vertices);
    for (std::uint32_t v = sides; v < (rings - 1) * sides; ++v) {
        // A facet spans pi / 24 = 0.13 rad; its normal tilts by at most half of that against the vertex, and
        // averaging over the facets around removes most of it.
        EXPECT_GT(vertices[v].normal.dot(vertices[v].position.normalized()), std::cos(0.065f));
    }
}

TEST(Normals, OfCollapsedTriangleAreFinite) {
    std::vector<view::LitVertex> vertices(3);
    const std::array<Triangle, 1> collapsed{{{0, 1, 2}}};
    view::recompute_normals(collapsed, vertices);
    for (const view::LitVertex& vertex : vertices) {
        EXPECT_NEAR(vertex.normal.norm(), 1.0f, 1e-6f);
    }
}

}  // namespace
}  // namespace eti
