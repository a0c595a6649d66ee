// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "client/render/material.hpp"
#include "client/render/mesh/creased_mesh.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.emplace_back(0.01f * static_cast<float>(i & 1),
                                   0.01f * static_cast<float>((i >> 1) & 1),
                                   0.01f * static_cast<float>(i >> 2));
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

TEST(CreasedMesh, KeepsCubeEdgesSharp) {
    const render::CreasedMesh mesh = render::creased(cube(), 0.7f);
    ASSERT_EQ(mesh.triangles.size(), 12u);
    for (const view::LitVertex& vertex : mesh.vertices) {
        EXPECT_NEAR(vertex.normal.cwiseAbs().maxCoeff(), 1.0f, 1e-6f) << "one of the axes";
        // Outwards: away from the centre.
        EXPECT_GT(vertex.normal.dot(vertex.position - Vec3f::Constant(0.005f)), 0.0f);
    }
}

TEST(CreasedMesh, SmoothsBelowCreaseAngle) {
    const render::CreasedMesh mesh = render::creased(cube(), 1.6f);
    for (const view::LitVertex& vertex : mesh.vertices) {
        EXPECT_LT(vertex.normal.cwiseAbs().maxCoeff(), 0.95f);
    }
}

// A strip whose faces turn by 30 degrees from one to the next: each neighbour is within 40 degrees, the next
// one is not. All of them about a common corner must have one normal there, otherwise one would stand out.
TEST(CreasedMesh, SmoothlyConnectedFacesShareOneNormal) {
    TriangleMesh fan;
    fan.vertices.emplace_back(0.0f, 0.0f, 0.01f);
    for (int i = 0; i < 4; ++i) {
        const float turn = 0.6f * static_cast<float>(i);
        fan.vertices.emplace_back(0.01f * std::cos(turn), 0.01f * std::sin(turn), 0.0f);
    }
    fan.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    const render::CreasedMesh mesh = render::creased(fan, 0.7f);
    for (std::size_t t = 1; t < 3; ++t) {
        EXPECT_LT((mesh.vertices[3 * t].normal - mesh.vertices[0].normal).norm(), 1e-6f);
    }
    const render::CreasedMesh sharp = render::creased(fan, 0.2f);
    EXPECT_GT((sharp.vertices[6].normal - sharp.vertices[0].normal).norm(), 0.3f);
}

float brightness(const render::VertexColour& colour) {
    return static_cast<float>(colour[0] + colour[1] + colour[2]) / 3.0f;
}

TEST(SurfaceColours, CordsAndClothShowNoVessels) {
    const auto vessels = [](Tissue tissue) {
        bus::RestSurface surface;
        surface.tissue = tissue;
        surface.mesh = cube();
        surface.triangle_tissue.assign(surface.mesh.triangles.size(), tissue);
        return render::surface_appearance(surface, {}).relief.front()[1];
    };
    EXPECT_EQ(vessels(Tissue::larynx), 255);
    EXPECT_EQ(vessels(Tissue::vocal_cord), 0);
    EXPECT_EQ(vessels(Tissue::cloth), 0);
    EXPECT_LT(vessels(Tissue::tongue), 128);
}

// A border of tissues is not one of triangles: neighbours of its vertices take part.
TEST(SurfaceColours, TissuesBlendAcrossSeveralEdges) {
    constexpr int columns = 40, rows = 4, border = columns / 2;
    bus::RestSurface strip;
    strip.tissue = Tissue::larynx;
    for (int y = 0; y <= rows; ++y) {
        for (int x = 0; x <= columns; ++x) {
            strip.mesh.vertices.emplace_back(0.3e-3f * static_cast<float>(x), 0.3e-3f * static_cast<float>(y),
                                             0.0f);
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const auto a = static_cast<std::uint32_t>(y * (columns + 1) + x), b = a + columns + 1;
            strip.mesh.triangles.push_back({a, a + 1, b});
            strip.mesh.triangles.push_back({b, a + 1, b + 1});
            strip.triangle_tissue.insert(strip.triangle_tissue.end(), 2,
                                         x < border ? Tissue::larynx : Tissue::vocal_cord);
        }
    }
    const auto relief = render::surface_appearance(strip, {}).relief;
    const auto vessels = [&](int x) {
        return int{relief[static_cast<std::size_t>(rows / 2 * (columns + 1) + x)][1]};
    };
    EXPECT_EQ(vessels(2), 255);
    EXPECT_EQ(vessels(columns - 2), 0);
    for (int x = border - 2; x < border + 2; ++x) {
        EXPECT_GT(vessels(x), vessels(x + 1)) << x;
        EXPECT_GT(vessels(x), 0);
        EXPECT_LT(vessels(x + 1), 255);
    }
}

TEST(SurfaceColours, SkinIsPalerAndDrierThanThroat) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    const bus::RestSurface& body = scene.surfaces().at("body").model();
    const auto [colours, relief] = render::surface_appearance(body, scene.rest_landmarks());
    ASSERT_EQ(colours.size(), body.mesh.vertices.size());
    constexpr int hairless = 127;
    double skin = 0, lining = 0, skin_wet = 0, lining_wet = 0;
    int skins = 0, linings = 0;
    for (std::size_t v = 0; v < colours.size(); ++v) {
        const Vec3f& p = body.mesh.vertices[v];
        if (p.z() > 0.03f && relief[v][3] == hairless) {
            skin += brightness(colours[v]);
            skin_wet += colours[v][3];
            ++skins;
        }
        // The throat's rear wall, 4 cm behind the mouth.
        if (std::abs(p.x()) < 0.004f && p.y() > 0.036f && p.y() < 0.05f && p.z() > -0.015f && p.z() < 0.0f) {
            lining += brightness(colours[v]);
            lining_wet += colours[v][3];
            ++linings;
        }
    }
    ASSERT_GT(skins, 50);
    ASSERT_GT(linings, 5);
    EXPECT_GT(skin / skins, 1.2 * lining / linings);
    EXPECT_LT(skin_wet / skins, 60.0);
    EXPECT_GT(lining_wet / linings, 200.0);
}

TEST(SurfaceColours, IgnoreLandmarkMotion) {
    // The same scene, joined by a late client that received live landmarks before surfaces.
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView early, late;
    synthetic::fill(early, source);
    auto live = synthetic::metrics(source, 5, 0.0f);
    for (msg::Vec3& landmark : live.landmarks()) {
        landmark.y(landmark.y() + 0.02f);
    }
    late.apply(live);
    synthetic::fill(late, source);
    late.apply(live);
    const auto& body = early.surfaces().at("body").model();
    EXPECT_EQ(render::surface_appearance(body, early.rest_landmarks()).colours,
              render::surface_appearance(body, late.rest_landmarks()).colours);
    EXPECT_NE(early.landmarks(), late.landmarks());
}

}  // namespace
}  // namespace eti
