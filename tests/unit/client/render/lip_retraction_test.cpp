// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/lip_retraction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/shaders/shaders.hpp"
#include "common/math/random.hpp"

namespace eti {
namespace {

struct Point {
    Vec3f place, normal;
};

/// Result of the vertex shader of all meshes.
std::vector<Point> drawn_lips(const std::vector<Point>& points, const LipRetraction& lips) {
    render::ShaderProgram program("lips", {"RETRACT"}, render::shaders::mesh_vertex, {"world", "normal_at"});
    program.use();
    program.set("model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    program.set("view_projection", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    render::apply(lips, program);
    const render::VertexArray array;
    const render::Buffer from, to;
    const auto bytes = static_cast<GLsizeiptr>(points.size() * sizeof(Point));
    glBindVertexArray(array.name());
    glBindBuffer(GL_ARRAY_BUFFER, from.name());
    glBufferData(GL_ARRAY_BUFFER, bytes, points.data(), GL_STATIC_DRAW);
    for (GLuint i = 0; i < 2; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(Point),
                              reinterpret_cast<const void*>(i * sizeof(Vec3f)));
    }
    glBindBuffer(GL_ARRAY_BUFFER, to.name());
    glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STREAM_READ);
    // Drawing needs a complete framebuffer, even where nothing is rasterised.
    const render::Framebuffer framebuffer;
    const render::Renderbuffer pixel;
    glBindRenderbuffer(GL_RENDERBUFFER, pixel.name());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, pixel.name());
    render::capture(to, points.size());
    std::vector<Point> read(points.size());
    glBindBuffer(GL_ARRAY_BUFFER, to.name());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, bytes, read.data());
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    return read;
}

TEST(LipRetractionShader, MatchesServerLipRetraction) {
    const render::HeadlessContext context;
    Landmarks now = zero_landmarks();
    const auto set = [&](Landmark which, const Vec3f& place) {
        now[static_cast<std::size_t>(which)] = place;
    };
    set(Landmark::upper_gum, {0.0f, 0.008f, 0.060f});
    set(Landmark::lower_gum, {0.0f, -0.016f, 0.060f});
    set(Landmark::upper_lip, {0.0f, 0.003f, 0.068f});
    set(Landmark::lower_lip, {0.0f, -0.007f, 0.068f});
    const LipRetraction lips = lip_retraction(Vec3f(0.01f, 0.02f, 0.36f), now);
    Random random(4);
    std::vector<Point> points;
    for (int i = 0; i < 4000; ++i) {
        const Vec3f normal(random.normal(), random.normal(), random.normal());
        points.push_back({Vec3f(0.06f * (random.uniform() - 0.5f), 0.08f * (random.uniform() - 0.5f),
                                0.055f + 0.02f * random.uniform()),
                          normal.normalized()});
    }
    const std::vector<Point> held = drawn_lips(points, lips);
    float moved = 0.0f;
    double turned = 0.0, wrong = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& [place, normal] = points[i];
        // Both in single precision at 0.1 m: roundings of 1e-8 m, amplified by slopes of four.
        EXPECT_LT((held[i].place - lips.retract_lips(place)).norm(), 1e-6f) << place.transpose();
        moved = std::max(moved, (held[i].place - place).norm());
        // A normal stays perpendicular to both tangents, whose images are known.
        const auto way = [&](const Vec3f& along) {
            const Vec3f step = 0.05e-3f * along;
            return Vec3f(lips.retract_lips(place + step) - lips.retract_lips(place - step));
        };
        const Vec3f aside = normal.unitOrthogonal();
        const Vec3f expected = way(aside).cross(way(normal.cross(aside))).normalized();
        turned += (expected - normal).norm();
        wrong += (expected - held[i].normal.normalized()).norm();
    }
    EXPECT_GT(moved, 5e-3f) << "nothing was held aside";
    EXPECT_GT(turned, 0.05 * static_cast<double>(points.size()));
    EXPECT_LT(wrong, 0.1 * turned);
}

}  // namespace
}  // namespace eti
