// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/measures.hpp"
#include "tests/bench/render/contact_sheet.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/math/units.hpp"
#include "tests/bench/render/surface_faults.hpp"

// References: views of spheres and boxes by elementary geometry.
namespace eti::bench {
namespace {

/// With `around` corners about its axis and half as many rings, closed and oriented outwards.
TriangleMesh sphere(const Vec3f& centre, float radius, std::uint32_t around) {
    TriangleMesh mesh;
    const std::uint32_t rings = around / 2;
    mesh.vertices.push_back(centre + radius * Vec3f::UnitY());
    for (std::uint32_t r = 1; r < rings; ++r) {
        for (std::uint32_t k = 0; k < around; ++k) {
            const float tilt = std::numbers::pi_v<float> * static_cast<float>(r) / static_cast<float>(rings);
            const float turn =
                2.0f * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(around);
            mesh.vertices.push_back(centre + radius * Vec3f(std::sin(tilt) * std::sin(turn), std::cos(tilt),
                                                            std::sin(tilt) * std::cos(turn)));
        }
    }
    mesh.vertices.push_back(centre - radius * Vec3f::UnitY());
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    const auto at = [&](std::uint32_t r, std::uint32_t k) { return 1 + (r - 1) * around + k % around; };
    for (std::uint32_t k = 0; k < around; ++k) {
        mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
        for (std::uint32_t r = 1; r + 1 < rings; ++r) {
            mesh.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
            mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
        }
        mesh.triangles.push_back({at(rings - 1, k), last, at(rings - 1, k + 1)});
    }
    return mesh;
}

/// Meshes with their tissues, seen from outside.
struct Stage {
    std::vector<TriangleMesh> meshes;
    std::vector<std::vector<Tissue>> tissues;

    MeshSet shapes(std::size_t blade = 1000) {
        MeshSet all;
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            tissues.emplace_back(meshes[i].triangles.size(), Tissue::soft);
        }
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            if (i == blade) {
                all.blade_triangles = meshes[i].triangles;
                all.blade = meshes[i].vertices;
                continue;
            }
            SurfaceMesh& shape = all.organs.emplace_back();
            shape.name = "organ " + std::to_string(i);
            shape.triangles = meshes[i].triangles;
            shape.triangle_tissue = tissues[i];
            shape.rest = meshes[i].vertices;
            shape.vertices = meshes[i].vertices;
        }
        return all;
    }
};

render::Camera from_front(float distance) {
    render::Camera camera;
    camera.eye = Vec3f(0.0f, 0.0f, distance);
    camera.target = Vec3f::Zero();
    camera.up = Vec3f::UnitY();
    camera.vertical_fov = 40.0f * degree;
    camera.near_plane = 0.01f;
    camera.far_plane = 2.0f;
    return camera;
}

TEST(Raster, SphereCoversItsProjectedDisc) {
    Stage stage{{sphere(Vec3f::Zero(), 0.05f, 48)}, {}};
    const Raster raster = raster_of(stage.shapes(), from_front(0.3f), 400, 400);
    const auto covered = std::ranges::count_if(raster.hits(), [](const Hit& hit) { return hit.object == 0; });
    // The tangent cone: sin = r / d; its circle in the picture follows from the focal length.
    const double angle = std::asin(0.05 / 0.3), focal = 200.0 / std::tan(20.0 * degree);
    const double disc = std::numbers::pi * std::pow(focal * std::tan(angle), 2);
    EXPECT_NEAR(static_cast<double>(covered) / disc, 1.0, 0.01);
    EXPECT_TRUE(std::ranges::none_of(raster.hits(), &Hit::back));
}

TEST(Raster, InvertedSphereShowsBackFaces) {
    Stage stage{{sphere(Vec3f::Zero(), 0.05f, 24)}, {}};
    for (Triangle& t : stage.meshes[0].triangles) {
        std::swap(t[1], t[2]);
    }
    const Raster raster = raster_of(stage.shapes(), from_front(0.3f), 100, 100);
    EXPECT_TRUE(
        std::ranges::all_of(raster.hits(), [](const Hit& hit) { return hit.object < 0 || hit.back; }));
}

TEST(Measures, CountsBackFacePixels) {
    const auto back = render::back_colour(Tissue::tongue), front = render::object_colour(Tissue::tongue);
    render::Image ids{
        .width = 2, .height = 1, .rgba = {back[0], back[1], back[2], 255, front[0], front[1], front[2], 255}};
    EXPECT_EQ(back_faces_percent(ids), 50.0);
}

TEST(Raster, ClipsGeometryBehindEye) {
    Stage stage{{sphere(Vec3f(0.0f, 0.0f, 0.6f), 0.05f, 24)}, {}};
    const Raster raster = raster_of(stage.shapes(), from_front(0.3f), 100, 100);
    EXPECT_TRUE(std::ranges::all_of(raster.hits(), [](const Hit& hit) { return hit.object == -1; }));
}

TEST(SurfaceFaults, CountsCrossingsInView) {
    // Two triangles that pass through each other once, before the eye and behind a sphere.
    TriangleMesh crossed{{{-0.01f, -0.01f, 0.1f},
                          {0.01f, -0.01f, 0.1f},
                          {0.0f, 0.01f, 0.1f},
                          {0.0f, -0.005f, 0.09f},
                          {0.0f, -0.005f, 0.11f},
                          {0.0f, -0.02f, 0.1f}},
                         {{0, 1, 2}, {3, 4, 5}}};
    const auto seen = [](TriangleMesh mesh, float offset) {
        for (Vec3f& vertex : mesh.vertices) {
            vertex.z() += offset;
        }
        Stage stage{{sphere(Vec3f::Zero(), 0.05f, 24), mesh}, {}};
        const MeshSet shapes = stage.shapes();
        const render::Camera camera = from_front(0.3f);
        return SurfaceFaults(shapes).in_view(raster_of(shapes, camera, 200, 200), camera);
    };
    EXPECT_EQ(seen(crossed, 0.0f).crossings, 1);
    EXPECT_EQ(seen(crossed, -0.2f).crossings, 0);
    crossed.vertices[4].z() = 0.095f;
    EXPECT_EQ(seen(crossed, 0.0f).crossings, 0);
}

TEST(SurfaceFaults, CountsOpenEdgesInView) {
    TriangleMesh open = sphere(Vec3f::Zero(), 0.05f, 24);
    const auto count = [](const TriangleMesh& mesh) {
        Stage stage{{mesh}, {}};
        const MeshSet shapes = stage.shapes();
        const render::Camera camera = from_front(0.3f);
        return SurfaceFaults(shapes).in_view(raster_of(shapes, camera, 200, 200), camera).open_edges;
    };
    EXPECT_EQ(count(open), 0);
    std::erase_if(open.triangles, [&](const Triangle& t) {
        const Vec3f middle = (open.vertices[t[0]] + open.vertices[t[1]] + open.vertices[t[2]]) / 3.0f;
        return middle.z() < -0.045f;
    });
    EXPECT_EQ(count(open), 0);  // a hole behind
    for (Vec3f& vertex : open.vertices) {
        vertex = Vec3f(-vertex.x(), vertex.y(), -vertex.z());
    }
    EXPECT_GT(count(open), 0);
}

TEST(Measures, DetectsBladeInsideButNotBehindTissue) {
    const auto organ = sphere(Vec3f::Zero(), 0.05f, 24);
    Stage within{{organ, sphere(Vec3f::Zero(), 0.02f, 24)}, {}};
    Stage behind{{organ, sphere(Vec3f(0.0f, 0.0f, -0.1f), 0.02f, 24)}, {}};
    Stage before{{organ, sphere(Vec3f(0.0f, 0.0f, 0.1f), 0.02f, 24)}, {}};
    EXPECT_GT(blade_in_tissue_percent(within.shapes(1), from_front(0.3f), 100, 100), 1.0);
    EXPECT_EQ(blade_in_tissue_percent(behind.shapes(1), from_front(0.3f), 100, 100), 0.0);
    EXPECT_EQ(blade_in_tissue_percent(before.shapes(1), from_front(0.3f), 100, 100), 0.0);
    // A cheek in front hides it, whatever it is embedded in.
    Stage hidden{{sphere(Vec3f(0.0f, 0.0f, 0.12f), 0.05f, 24), organ, sphere(Vec3f::Zero(), 0.02f, 24)}, {}};
    EXPECT_EQ(blade_in_tissue_percent(hidden.shapes(2), from_front(0.3f), 100, 100), 0.0);
}

// Two tongues, a black one in the middle and a white one beside it.
TEST(Measures, MeasuresLightWithinLensDisc) {
    Stage stage{{sphere(Vec3f::Zero(), 0.02f, 24), sphere(Vec3f(0.08f, 0.0f, 0.0f), 0.02f, 24)}, {}};
    MeshSet shapes = stage.shapes();
    for (SurfaceMesh& shape : shapes.organs) {
        std::ranges::fill(shape.triangle_tissue, Tissue::tongue);
    }
    const render::Camera camera = from_front(0.3f);
    render::Image picture{.width = 100, .height = 100, .rgba = std::vector<std::uint8_t>(40000, 0)};
    for (std::size_t p = 0; p < picture.rgba.size(); ++p) {
        picture.rgba[p] = p / 4 % 100 < 65 ? 0 : 255;
    }
    const Raster raster = raster_of(shapes, camera, 100, 100);
    EXPECT_NEAR(luminances(picture, raster, shapes, camera, {}, 2.0f).tongue, 0.5, 0.1);
    EXPECT_EQ(luminances(picture, raster, shapes, camera, {}, 0.3f).tongue, 0.0);
}

TEST(Measures, EdgeStretchMatchesScaling) {
    const TriangleMesh corner{
        {{0.0f, 0.0f, 0.0f}, {1e-3f, 0.0f, 0.0f}, {0.0f, 1e-3f, 0.0f}, {0.0f, 0.0f, 1e-3f}},
        {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    Stage stage{{corner}, {}};
    MeshSet shapes = stage.shapes();
    for (Vec3f& p : shapes.organs[0].vertices) {
        p.x() *= 2.5f;
    }
    EXPECT_NEAR(edge_stretch(shapes).ratio, 2.5, 1e-5);
}

TEST(Measures, FinerSphereHasFinerOutline) {
    Stage coarse{{sphere(Vec3f::Zero(), 0.05f, 12)}, {}}, fine{{sphere(Vec3f::Zero(), 0.05f, 96)}, {}};
    const MeshSet a = coarse.shapes(), b = fine.shapes();
    const auto of = [](const MeshSet& s) {
        return outlines(s, raster_of(s, from_front(0.3f), 400, 400), 10.0).at(0);
    };
    // Sides of a polygon about a circle of 92 pixels: 48 pixels long, and 6.
    EXPECT_LT(of(a).fine_percent, 10.0);
    EXPECT_EQ(of(b).fine_percent, 100.0);
}

// About a circle of 2 pixels, which is 12 pixels long.
TEST(Measures, SkipsOutlinesOfFewPixels) {
    Stage stage{{sphere(Vec3f::Zero(), 0.001f, 12)}, {}};
    const MeshSet shapes = stage.shapes();
    EXPECT_TRUE(outlines(shapes, raster_of(shapes, from_front(0.3f), 400, 400), 10.0).empty());
}

TEST(Measures, PlaneCutsSphereInOneClosedContour) {
    Stage stage{{sphere(Vec3f::Zero(), 0.05f, 24)}, {}};
    auto contours = section_contours(stage.shapes(), Vec3f(1e-3f, 0.0f, 0.0f), Vec3f::UnitX());
    ASSERT_EQ(contours.size(), 1u);
    EXPECT_EQ(contours[0].closed, 1);
    EXPECT_EQ(contours[0].open, 0);
    stage.meshes[0].triangles.resize(stage.meshes[0].triangles.size() / 2);  // a hole
    contours = section_contours(stage.shapes(), Vec3f(0.0f, 0.0f, 1e-3f), Vec3f(0.0f, 1.0f, 1.0f));
    ASSERT_EQ(contours.size(), 1u);
    EXPECT_GE(contours[0].open, 1);
}

TEST(Measures, HalfCoveredOpeningIsHalfVisible) {
    const std::vector<Vec3f> square{
        {-0.01f, -0.01f, 0.0f}, {0.01f, -0.01f, 0.0f}, {0.01f, 0.01f, 0.0f}, {-0.01f, 0.01f, 0.0f}};
    TriangleMesh screen{
        {{0.0f, -0.1f, 1e-3f}, {0.1f, -0.1f, 1e-3f}, {0.1f, 0.1f, 1e-3f}, {0.0f, 0.1f, 1e-3f}},
        {{0, 1, 2}, {0, 2, 3}}};
    Stage stage{{screen}, {}};
    const render::Camera camera = from_front(0.3f);
    const Raster raster = raster_of(stage.shapes(), camera, 800, 800);
    EXPECT_NEAR(opening_in_picture(raster, camera, square, 0.5e-3f), 50.0, 1.0);
    // Surfaces nearer than the tolerance do not hide it.
    EXPECT_NEAR(opening_in_picture(raster, camera, square, 2e-3f), 100.0, 1e-6);
}

TEST(Measures, AnyFullChannelClipsPixel) {
    // Opacity is always full.
    const render::Image picture{
        .width = 4,
        .height = 1,
        .rgba = {254, 254, 254, 255, 255, 3, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255}};
    EXPECT_EQ(clipped_percent(picture), 50.0);
}

TEST(Measures, ComputesPercentageOfDifferingPixels) {
    const render::Image a{.width = 2, .height = 2, .rgba = std::vector<std::uint8_t>(16, 100)};
    render::Image b = a;
    b.rgba[4] = 130;
    b.rgba[8] = 110;
    EXPECT_EQ(differing_pixels_percent(a, b, 20), 25.0);
    EXPECT_EQ(differing_pixels_percent(a, {.width = 1, .height = 1, .rgba = {0, 0, 0, 0}}, 20), 100.0);
}

TEST(Measures, PicturesSideBySideKeepTheirPixels) {
    const render::Image left{.width = 1, .height = 2, .rgba = {1, 1, 1, 255, 2, 2, 2, 255}};
    const render::Image right{.width = 1, .height = 2, .rgba = {3, 3, 3, 255, 4, 4, 4, 255}};
    const render::Image both = side_by_side(left, right);
    EXPECT_EQ(both.width, 2);
    EXPECT_EQ(both.rgba, (std::vector<std::uint8_t>{1, 1, 1, 255, 3, 3, 3, 255, 2, 2, 2, 255, 4, 4, 4, 255}));
}

}  // namespace
}  // namespace eti::bench
