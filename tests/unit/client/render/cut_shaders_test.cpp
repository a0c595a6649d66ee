// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti {
namespace {

constexpr int side = 512;             // pixels
constexpr float half = 0.025f;        // [m], of what they show
constexpr float radius = 0.02f;       // [m], of the surfaces shown
constexpr float cut_height = 0.005f;  // [m], of the cut above the middle
constexpr double metres = 2.0 * half / side;

// Concentric balls about the origin.
render::GpuMesh balls(const std::vector<float>& radii) {
    constexpr std::uint32_t rings = 40, sides = 80;
    std::vector<view::LitVertex> vertices;
    std::vector<Triangle> triangles;
    for (const float r : radii) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (std::uint32_t ring = 0; ring <= rings; ++ring) {
            for (std::uint32_t at = 0; at < sides; ++at) {
                const float polar = std::numbers::pi_v<float> * static_cast<float>(ring) / rings;
                const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(at) / sides;
                const Vec3f out(std::cos(polar), std::sin(polar) * std::cos(turn),
                                std::sin(polar) * std::sin(turn));
                vertices.push_back({r * out, out});
                if (ring < rings) {
                    const std::uint32_t here = first + ring * sides + at;
                    const std::uint32_t next = first + ring * sides + (at + 1) % sides;
                    triangles.push_back({here, next, here + sides});
                    triangles.push_back({next, next + sides, here + sides});
                }
            }
        }
    }
    return {triangles, vertices, std::vector<render::VertexColour>(vertices.size(), {255, 255, 255, 255})};
}

class CutShaders : public ::testing::Test {
  protected:
    CutShaders() {
        glBindRenderbuffer(GL_RENDERBUFFER, colour_.name());
        glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, side, side);
        glBindRenderbuffer(GL_RENDERBUFFER, stencil_.name());
        glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, side, side);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_.name());
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                                  stencil_.name());
        glViewport(0, 0, side, side);
        glDisable(GL_DEPTH_TEST);
        glDisable(GL_CULL_FACE);
        glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
        glClear(GL_COLOR_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    }
    void TearDown() override { EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR)); }

    // Projects onto the plane, which is perpendicular to x.
    static void set_up(render::ShaderProgram& program) {
        program.use();
        Eigen::Matrix4f onto = Eigen::Matrix4f::Zero();
        onto(0, 1) = onto(1, 2) = 1.0f / half;
        onto(3, 3) = 1.0f;
        program.set("view_projection", onto);
        program.set("plane", Eigen::Vector4f(-1.0f, 0.0f, 0.0f, cut_height));
        program.set("flat_colour", Eigen::Vector4f(1.0f, 1.0f, 1.0f, 1.0f));
    }

    // [m^2] of the pixels that are not black.
    static double area() {
        std::vector<std::uint8_t> pixels(4 * side * side);
        glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
        int lit = 0;
        for (std::size_t i = 0; i < pixels.size(); i += 4) {
            lit += pixels[i] > 127 ? 1 : 0;
        }
        return lit * metres * metres;
    }

    // [m^2] of the plane within a surface, by the fan of its contour.
    static double area_within(render::ShaderProgram& fan, const render::GpuMesh& mesh) {
        glClear(GL_COLOR_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
        fan.use();
        glEnable(GL_STENCIL_TEST);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glStencilFunc(GL_ALWAYS, 0, 0xff);
        glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
        glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
        mesh.draw();
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glStencilFunc(GL_NOTEQUAL, 0, 0xff);
        glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
        render::ShaderProgram face("face", {}, render::shaders::cut_plane_vertex,
                                   render::shaders::flat_fragment);
        set_up(face);
        face.set("pivot", Vec3f(cut_height, 0.0f, 0.0f));
        face.set("along", Vec3f(0.0f, 1.0f, 0.0f));
        face.set("across", Vec3f(0.0f, 0.0f, 1.0f));
        const render::VertexArray none;
        glBindVertexArray(none.name());
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
        glDisable(GL_STENCIL_TEST);
        return area();
    }

    // Area of the circle that the plane cuts out of a ball; an inscribed polygon of 80 sides lacks (2
    // pi/80)^2 / 6 = 0.1 %.
    static double disc(double r) { return std::numbers::pi * (r * r - cut_height * cut_height); }

    render::HeadlessContext context_;
    render::Framebuffer framebuffer_;
    render::Renderbuffer colour_, stencil_;
};

// Within 1 %: the polygon's 0.1 %, and pixels of a quarter of a thousandth of the area along the rim. An
// inner ball is a hollow if it is inverted, otherwise a fold of tissue over tissue.
TEST_F(CutShaders, FanExcludesHollowsAndIncludesFolds) {
    render::ShaderProgram fan("fan", {"FAN"}, render::shaders::cut_surface_vertex,
                              render::shaders::cut_geometry, render::shaders::flat_fragment);
    set_up(fan);
    // Outside of the contour, where a fan alone is farthest from its inside.
    fan.set("pivot", Vec3f(cut_height, 0.024f, 0.018f));
    const auto filled = [&](float inner) { return area_within(fan, balls({radius, inner})); };
    const double hollow = disc(radius) - disc(0.5 * radius);
    EXPECT_NEAR(filled(-0.5f * radius), hollow, 0.01 * hollow);
    EXPECT_NEAR(filled(0.5f * radius), disc(radius), 0.01 * disc(radius));
}

TEST_F(CutShaders, BandLiesInsideContour) {
    constexpr float width = 2e-3f;
    render::ShaderProgram band("band", {}, render::shaders::cut_surface_vertex, render::shaders::cut_geometry,
                               render::shaders::flat_fragment);
    set_up(band);
    band.set("width", width);
    balls({radius}).draw();
    const double outer = std::sqrt(disc(radius) / std::numbers::pi);
    const double expected = disc(radius) - std::numbers::pi * (outer - width) * (outer - width);
    // The rim is two circles of 110 mm each; a pixel's half along 1 % of it is 0.05 %.
    EXPECT_NEAR(area(), expected, 0.01 * expected);
}

}  // namespace
}  // namespace eti
