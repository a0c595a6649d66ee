// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/glottis_pass.hpp"

#include <vector>

#include "client/render/gpu_mesh.hpp"

namespace eti::render {
namespace {

constexpr std::string_view glottis_vertex_source = R"(
layout(location = 0) in vec3 position;
uniform mat4 view_projection;
void main() { gl_Position = view_projection * vec4(position, 1.0); }
)";
constexpr std::string_view glottis_fragment_source = R"(
uniform vec4 tint;
out vec4 pixel;
void main() { pixel = tint; }
)";

// Linear; bright enough to be seen in a lamp's light and in the dark.
const Eigen::Vector4f tint(0.05f, 0.75f, 0.25f, 0.45f);

}  // namespace

GlottisPass::GlottisPass() : program_("tinted glottis", {}, glottis_vertex_source, glottis_fragment_source) {}

void GlottisPass::draw(const Drawing& drawing) {
    const std::span<const Vec3f> contour = drawing.scene.glottis_contour();
    if (drawing.ids() || contour.size() < 3 || !drawing.scene.shows(&LiveValues::view_glottis)) {
        return;
    }
    // A fan about the middle, which sees every point of a glottis.
    Vec3f middle = Vec3f::Zero();
    for (const Vec3f& point : contour) {
        middle += point / static_cast<float>(contour.size());
    }
    std::vector<Vec3f> fan{middle};
    fan.insert(fan.end(), contour.begin(), contour.end());
    fan.push_back(contour.front());
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(fan.size() * sizeof(Vec3f)), fan.data(),
                 GL_STREAM_DRAW);
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), 0);
    program_.use();
    program_.set("view_projection", drawing.view_projection);
    program_.set("tint", tint);
    glDisable(GL_CULL_FACE);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDrawArrays(GL_TRIANGLE_FAN, 0, static_cast<GLsizei>(fan.size()));
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glEnable(GL_CULL_FACE);
}

}  // namespace eti::render
