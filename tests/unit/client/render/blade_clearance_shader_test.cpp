// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/blade_clearance_shader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "common/math/random.hpp"

namespace eti {
namespace {

// One pixel per point, with its position as the colour: the vertex shader's result, read back as floats.
constexpr const char* vertex = R"(
layout(location = 0) in vec3 point;
out vec3 place;
uniform float count;
void main() {
    place = give_way(point);
    gl_Position = vec4((float(gl_VertexID) + 0.5) / count * 2.0 - 1.0, 0.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
)";
constexpr const char* fragment = R"(
in vec3 place;
out vec4 pixel;
void main() { pixel = vec4(place, 1.0); }
)";

std::vector<Vec3f> drawn_giving_way(const std::vector<Vec3f>& points,
                                    const PosedBladeClearanceDeformer& give_way) {
    render::ShaderProgram program("give way", {}, render::blade_clearance_source() + vertex, fragment);
    program.use();
    render::apply(give_way, program);
    const auto count = static_cast<GLsizei>(points.size());
    program.set("count", static_cast<float>(count));

    GLuint texture = 0, frame = 0, array = 0, buffer = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, count, 1, 0, GL_RGBA, GL_FLOAT, nullptr);
    glGenFramebuffers(1, &frame);
    glBindFramebuffer(GL_FRAMEBUFFER, frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(points.size() * sizeof(Vec3f)), points.data(),
                 GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
    glViewport(0, 0, count, 1);
    glDrawArrays(GL_POINTS, 0, count);
    std::vector<std::array<float, 4>> pixels(points.size());
    glReadPixels(0, 0, count, 1, GL_RGBA, GL_FLOAT, pixels.data());
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    glDeleteBuffers(1, &buffer);
    glDeleteVertexArrays(1, &array);
    glDeleteFramebuffers(1, &frame);
    glDeleteTextures(1, &texture);

    std::vector<Vec3f> places;
    for (const auto& pixel : pixels) {
        places.emplace_back(pixel[0], pixel[1], pixel[2]);
    }
    return places;
}

TEST(BladeClearanceShader, MatchesServerDeformation) {
    const render::HeadlessContext context;
    const RigidTransform tool{quaternion_from(Vec3f(0.7f, -0.4f, 1.1f)), Vec3f(0.02f, -0.05f, 0.04f)};
    for (const Blade blade : {Blade::miller_0, Blade::miller_1}) {
        const Laryngoscope scope = make_laryngoscope(blade);
        // At the corner of a mouth whose gum lies 30 mm short of the tip.
        Landmarks mouth = zero_landmarks();
        const auto set = [&](Landmark which, const Vec3f& place) {
            mouth[static_cast<std::size_t>(which)] = tool * place;
        };
        const float gum = scope.blade_length - 30e-3f;
        set(Landmark::upper_gum, {9e-3f, -8e-3f, gum});
        set(Landmark::mouth_opening, {9e-3f, 2e-3f, gum - 6e-3f});
        set(Landmark::glottis, {9e-3f, 44e-3f, gum + 44e-3f});
        const PosedBladeClearanceDeformer give_way = blade_clearance_for(scope, tool, mouth);
        ASSERT_GT(give_way.give_way.aside, 1e-3f);
        Random random(3);
        std::vector<Vec3f> points;
        for (int i = 0; i < 4000; ++i) {
            points.push_back(tool * Vec3f(0.030f * (random.uniform() - 0.5f),
                                          0.024f * (random.uniform() - 0.5f),
                                          (scope.blade_length + 0.01f) * random.uniform()));
        }
        const std::vector<Vec3f> places = drawn_giving_way(points, give_way);
        float moved = 0.0f;
        for (std::size_t i = 0; i < points.size(); ++i) {
            // Both in single precision at 0.1 m: roundings of 1e-8 m, amplified by slopes of three.
            EXPECT_LT((places[i] - give_way(points[i])).norm(), 1e-6f) << points[i].transpose();
            moved = std::max(moved, (places[i] - points[i]).norm());
        }
        EXPECT_GT(moved, 2e-3f) << "nothing gave way";
    }
}

}  // namespace
}  // namespace eti
