// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/glottis_pass.hpp"

#include <vector>

#include "client/render/mesh/gpu_mesh.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti::render {
namespace {

// Linear; visible in the lamp's light and in the dark.
const Eigen::Vector4f tint(0.05f, 0.75f, 0.25f, 0.45f);

}  // namespace

GlottisPass::GlottisPass()
    : program_("tinted glottis", {}, shaders::glottis_vertex, shaders::glottis_fragment) {}

void GlottisPass::draw(const DrawContext& context) {
    const std::span<const Vec3f> contour = context.scene.glottis_contour();
    if (context.ids() || contour.size() < 3 || !context.scene.shows(&RuntimeParameters::view_glottis)) {
        return;
    }
    // A triangle fan about the centroid; a glottis is star-shaped.
    Vec3f middle = Vec3f::Zero();
    for (const Vec3f& point : contour) {
        middle += point / static_cast<float>(contour.size());
    }
    std::vector<Vec3f> fan{middle};
    fan.insert(fan.end(), contour.begin(), contour.end());
    fan.push_back(contour.front());
    glBindVertexArray(array_.name());
    upload(GL_ARRAY_BUFFER, vertices_, fan, GL_STREAM_DRAW);
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), 0);
    program_.use();
    program_.set("view_projection", context.view_projection);
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
