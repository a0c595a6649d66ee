// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/outline_tessellation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/shaders/shaders.hpp"
#include "client/render/views/camera.hpp"
#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti {
namespace {

using render::TessellatedFace;

// Corners a third of a turn apart, at an angle from a ball's pole, with outward normals.
std::array<view::LitVertex, 3> on_ball(float radius, float angle) {
    std::array<view::LitVertex, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
        const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(k) / 3.0f;
        const Vec3f out(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle));
        corners[k] = {radius * out, out};
    }
    return corners;
}

constexpr std::uint32_t rings = 32, sides = 64;
constexpr float between_rings = std::numbers::pi_v<float> / rings;  // [rad]

// Rings about the z axis, oriented outwards.
TriangleMesh ball_of(float radius) {
    TriangleMesh mesh;
    mesh.vertices = {radius * Vec3f::UnitZ(), -radius * Vec3f::UnitZ()};
    for (std::uint32_t ring = 1; ring < rings; ++ring) {
        const float polar = between_rings * static_cast<float>(ring);
        for (std::uint32_t side = 0; side < sides; ++side) {
            const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / sides;
            mesh.vertices.push_back(radius * Vec3f(std::sin(polar) * std::cos(turn),
                                                   std::sin(polar) * std::sin(turn), std::cos(polar)));
        }
    }
    const auto at = [](std::uint32_t ring, std::uint32_t side) {
        return 2 + (ring - 1) * sides + side % sides;
    };
    for (std::uint32_t side = 0; side < sides; ++side) {
        mesh.triangles.push_back({0, at(1, side), at(1, side + 1)});
        mesh.triangles.push_back({1, at(rings - 1, side + 1), at(rings - 1, side)});
        for (std::uint32_t ring = 1; ring + 1 < rings; ++ring) {
            mesh.triangles.push_back({at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)});
            mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)});
        }
    }
    return mesh;
}

TEST(BentFaces, ApproximateSphereOfTheirNormals) {
    // For a chord of half-angle t the bend is r sin^2 t cos t / 2, the arc's height r (1 - cos t): they
    // differ by less than r t^4, whereas flat triangles miss r t^2 / 2. A triangle's middle lies at most
    // twice the half-angle from its corners.
    constexpr float radius = 1e-3f, angle = 0.25f;
    const auto corners = on_ball(radius, angle);
    for (const Vec3f& shares : {Vec3f(0.5f, 0.5f, 0.0f), Vec3f(0.0f, 0.3f, 0.7f), Vec3f(0.4f, 0.3f, 0.3f)}) {
        const view::LitVertex place = render::curved_vertex(corners, shares);
        const Vec3f flat = shares.x() * corners[0].position + shares.y() * corners[1].position +
                           shares.z() * corners[2].position;
        const float missed = std::fabs(place.position.norm() - radius);
        EXPECT_LT(missed, radius * std::pow(angle, 4.0f)) << shares.transpose();
        EXPECT_LT(missed, 0.25f * (radius - flat.norm())) << "hardly rounder than a flat triangle";
        EXPECT_GT(place.normal.dot(place.position.normalized()), 0.999f);
    }
}

TEST(BentFaces, DisplacementIsBounded) {
    const auto corners = on_ball(5e-3f, 0.6f);
    const Vec3f middle = (corners[0].position + corners[1].position + corners[2].position) / 3.0f;
    const Vec3f place = render::curved_vertex(corners, Vec3f::Constant(1.0f / 3.0f)).position;
    EXPECT_NEAR((place - middle).norm(), render::max_bend, 1e-8f);
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(render::curved_vertex(corners, Vec3f::Unit(k)).position,
                  corners[static_cast<std::size_t>(k)].position)
            << "a corner has moved: neighbours that are not drawn finer would part from it";
    }
}

TEST(OutlineTessellation, MatchAlongEdgesAndCoverOutline) {
    constexpr float radius = 0.02f, away = 0.035f;
    const TriangleMesh ball = ball_of(radius);
    const render::TriangleBlocks blocks(ball.triangles, ball.vertices,
                                        std::vector<SkinWeights>(ball.vertices.size()));
    render::OutlineTessellation finer(blocks.triangles(), ball.vertices.size());
    render::Camera camera;
    camera.eye = away * Vec3f::UnitZ();
    camera.target = Vec3f::Zero();
    camera.up = Vec3f::UnitY();
    camera.vertical_fov = 75.0f * degree;
    camera.near_plane = 1e-3f;
    const render::OutlineView look{camera.projection(1.0f) * camera.view(), camera.eye};
    const std::vector<render::TriangleBlocks::Range> all{{0, blocks.triangles().size()}};
    finer.choose(all, look, [&](std::uint32_t v) { return ball.vertices[v]; });
    ASSERT_GT(finer.faces().size(), 20u);
    EXPECT_LT(finer.faces().size(), blocks.triangles().size() / 3);

    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<int>> steps;
    for (std::size_t t = 0; t < blocks.triangles().size(); ++t) {
        TessellatedFace face{.corners = blocks.triangles()[t]};
        std::ranges::sort(face.corners);
        if (const std::int32_t which = finer.face_of(t); which >= 0) {
            ASSERT_EQ(finer.faces()[static_cast<std::size_t>(which)].corners, face.corners);
            face = finer.faces()[static_cast<std::size_t>(which)];
        }
        const auto& [a, b, c] = face.corners;
        steps[{a, b}].push_back(face.steps[0]);
        steps[{b, c}].push_back(face.steps[1]);
        steps[{a, c}].push_back(face.steps[2]);
    }
    // An eye at a distance d from a ball's middle sees its outline at an angle acos(r / d) from the axis.
    const float outline = std::acos(radius / away);
    const auto from_outline = [&](std::uint32_t v) {
        return std::acos(std::clamp(ball.vertices[v].z() / radius, -1.0f, 1.0f)) - outline;
    };
    int along = 0;
    for (const auto& [edge, both] : steps) {
        ASSERT_EQ(both.size(), 2u);
        EXPECT_EQ(both[0], both[1]);
        const float a = from_outline(edge.first), b = from_outline(edge.second);
        if (std::fabs(a - b) < 1e-4f && std::fabs(a) < 0.45f * between_rings) {
            // An edge of a ring lies across the line of sight: its length over its depth in front of the eye.
            const Vec3f &p = ball.vertices[edge.first], &q = ball.vertices[edge.second];
            const float pixels =
                540.0f / std::tan(0.5f * camera.vertical_fov) * (p - q).norm() / (away - p.z());
            EXPECT_NEAR(pixels, 48.0f, 1.0f);
            EXPECT_EQ(both[0], static_cast<int>(std::ceil(pixels / 9.0f))) << "an edge along the outline";
            ++along;
        }
        if (std::min(std::fabs(a), std::fabs(b)) > 2.1f * between_rings) {
            EXPECT_EQ(both[0], 1) << "an edge far from the outline is divided";
        }
    }
    EXPECT_EQ(along, static_cast<int>(sides));

    // Without some of the triangles about a vertex it is unknown whether the others divide its edges.
    const std::vector<render::TriangleBlocks::Range> half{{0, blocks.triangles().size() / 2}};
    finer.choose(half, look, [&](std::uint32_t v) { return ball.vertices[v]; });
    std::map<std::uint32_t, std::size_t> left_out;
    for (std::size_t t = half[0].count; t < blocks.triangles().size(); ++t) {
        EXPECT_EQ(finer.face_of(t), -1);
        for (const std::uint32_t v : blocks.triangles()[t]) {
            ++left_out[v];
        }
    }
    for (const TessellatedFace& face : finer.faces()) {
        constexpr std::array<std::pair<std::size_t, std::size_t>, 3> ends{{{0, 1}, {1, 2}, {0, 2}}};
        for (std::size_t e = 0; e < 3; ++e) {
            const bool border = left_out.contains(face.corners[ends[e].first]) &&
                                left_out.contains(face.corners[ends[e].second]);
            EXPECT_TRUE(!border || face.steps[e] == 1) << "only one side of an edge is divided";
        }
    }
}

TEST(OutlineTessellation, EncodeStepsInFourBits) {
    std::vector<int> all;
    for (int code = 0; code < render::step_codes; ++code) {
        all.push_back(render::steps_of(code));
    }
    EXPECT_EQ(all, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32}));
    EXPECT_EQ(render::steps_of(render::code_of(8.1f)), 10);
    EXPECT_EQ(render::steps_of(render::code_of(24.0f)), 24);
    EXPECT_EQ(render::steps_of(render::code_of(1e9f)), 32);
    EXPECT_EQ(render::pack({0xabcdeu, {1, 10, 32}, 1}), 0xf80abcdeu);
}

TEST(OutlineTessellation, GridsCoverTriangleExactlyOnce) {
    for (const std::array<std::uint8_t, 3>& steps :
         {std::array<std::uint8_t, 3>{1, 5, 2}, {7, 7, 7}, {1, 1, 32}, {3, 10, 1}}) {
        for (const bool turned : {false, true}) {
            const TessellatedFace face{
                .corners = {0, 1, 2}, .steps = steps, .turned = static_cast<std::uint8_t>(turned ? 1 : 0)};
            std::vector<Vec3f> places;
            for (int j = 0; j <= face.grid(); ++j) {
                for (int i = 0; i <= face.grid() - j; ++i) {
                    places.push_back(render::barycentric_at(face, i, j));
                    EXPECT_NEAR(places.back().sum(), 1.0f, 1e-6f);
                }
            }
            float area = 0.0f;
            for (const Triangle& t : render::grid_triangles(face.grid(), turned)) {
                const Vec3f u = places[t[1]] - places[t[0]], v = places[t[2]] - places[t[0]];
                const float part = (turned ? -1.0f : 1.0f) * (u.y() * v.z() - u.z() * v.y());
                EXPECT_GE(part, -1e-6f) << "a triangle is turned over";
                area += part;
            }
            EXPECT_NEAR(area, 1.0f, 1e-5f);
        }
    }
}

TEST(FinerShaders, MatchCpuBending) {
    const render::HeadlessContext context;
    // One triangle, with vertices in descending order; every point of its grid is a vertex.
    Random random(5);
    std::array<view::LitVertex, 3> vertices = on_ball(1.2e-3f, 0.4f);
    for (view::LitVertex& vertex : vertices) {
        vertex.position += 0.1e-3f * Vec3f(random.uniform(), random.uniform(), random.uniform());
    }
    const std::array<std::uint32_t, 6> triangles{0, 0, 0, 2, 1, 0};
    const TessellatedFace face{.corners = {0, 1, 2}, .steps = {3, 28, 1}, .turned = 1};
    struct Place {
        std::array<std::int32_t, 2> step;
        std::uint32_t face;
    };
    std::vector<Place> places;
    for (int j = 0; j <= face.grid(); ++j) {
        for (int i = 0; i <= face.grid() - j; ++i) {
            places.push_back({{i, j}, render::pack({1u, face.steps, face.turned})});
        }
    }
    render::ShaderProgram program(
        "finer", {"FINER"},
        std::string(render::shaders::finer_vertex) +
            "out vec3 place_at;\nout vec3 normal_at;\nout vec3 face_at;\n"
            "void main() { finer_vertex(); place_at = position; normal_at = normal; face_at = flat_normal; }",
        {"place_at", "normal_at", "face_at"});
    program.use();
    program.set("grid", face.grid());
    program.set("max_bend", render::max_bend);
    const render::VertexArray array;
    const render::Buffer input, corners, indices, output;
    const std::array<render::Texture, 2> textures;
    const auto source = [&](int unit, const char* name, const render::Buffer& buffer, GLenum format,
                            const void* data, std::size_t size) {
        glBindBuffer(GL_TEXTURE_BUFFER, buffer.name());
        glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(size), data, GL_STATIC_DRAW);
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_BUFFER, textures[static_cast<std::size_t>(unit)].name());
        glTexBuffer(GL_TEXTURE_BUFFER, format, buffer.name());
        program.set(name, unit);
    };
    source(0, "skinned", corners, GL_RG32F, vertices.data(), sizeof vertices);
    source(1, "triangles", indices, GL_R32UI, triangles.data(), sizeof triangles);
    glBindVertexArray(array.name());
    glBindBuffer(GL_ARRAY_BUFFER, input.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(places.size() * sizeof(Place)), places.data(),
                 GL_STATIC_DRAW);
    const auto attribute = [](GLuint which, GLint size, GLenum type, std::size_t at) {
        glEnableVertexAttribArray(which);
        glVertexAttribIPointer(which, size, type, sizeof(Place), reinterpret_cast<const void*>(at));
    };
    attribute(0, 2, GL_INT, offsetof(Place, step));
    attribute(1, 1, GL_UNSIGNED_INT, offsetof(Place, face));
    struct Drawn {
        Vec3f position, normal, face;
    };
    std::vector<Drawn> drawn(places.size());
    glBindBuffer(GL_ARRAY_BUFFER, output.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(drawn.size() * sizeof drawn[0]), nullptr,
                 GL_STATIC_READ);
    // Drawing needs a complete framebuffer, even where nothing is rasterised.
    const render::RenderTarget target(1, 1, 1);
    target.bind_scene();
    render::capture(output, places.size());
    glBindBuffer(GL_ARRAY_BUFFER, output.name());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(drawn.size() * sizeof drawn[0]),
                       drawn.data());
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    const Vec3f face_normal = (vertices[1].position - vertices[2].position)
                                  .cross(vertices[0].position - vertices[2].position)
                                  .normalized();
    float most = 0.0f;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Vec3f shares = render::barycentric_at(face, places[i].step[0], places[i].step[1]);
        const view::LitVertex here = render::curved_vertex(vertices, shares);
        // Roundings of numbers of a millimetre.
        EXPECT_LT((drawn[i].position - here.position).norm(), 1e-9f) << shares.transpose();
        EXPECT_LT((drawn[i].normal - here.normal).norm(), 1e-5f);
        EXPECT_LT((drawn[i].face.normalized() - face_normal).norm(), 1e-5f);
        const Vec3f flat = shares.x() * vertices[0].position + shares.y() * vertices[1].position +
                           shares.z() * vertices[2].position;
        most = std::max(most, (drawn[i].position - flat).norm());
    }
    EXPECT_GT(most, 0.02e-3f) << "nothing is bent";
}

}  // namespace
}  // namespace eti
