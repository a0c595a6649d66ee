// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/liquid/foam_renderer.hpp"

#include <array>
#include <string>
#include <vector>

#include "client/render/draw_context.hpp"
#include "client/render/passes/shadow_pass.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti::render {
namespace {

// Half floats relative to one bubble: 0.03 mm resolution within 6 cm.
using Packed = std::array<Eigen::half, 4>;
static_assert(sizeof(Packed) == 8);

}  // namespace

FoamRenderer::FoamRenderer() : programs_("foam", shaders::foam_vertex, shaders::foam_fragment) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, bubbles_.name());
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 4, GL_HALF_FLOAT, GL_FALSE, sizeof(Packed), nullptr);
    glBindVertexArray(0);
}

void FoamRenderer::upload(std::span<const view::Bubble> bubbles) {
    count_ = static_cast<GLsizei>(bubbles.size());
    if (bubbles.empty()) {
        return;
    }
    origin_ = bubbles.front().position;
    std::vector<Packed> packed;
    packed.reserve(bubbles.size());
    for (const view::Bubble& bubble : bubbles) {
        const Vec3f p = bubble.position - origin_;
        packed.push_back(
            {Eigen::half(p.x()), Eigen::half(p.y()), Eigen::half(p.z()), Eigen::half(bubble.radius_now())});
    }
    render::upload(GL_ARRAY_BUFFER, bubbles_, packed, GL_STREAM_DRAW);
}

void FoamRenderer::draw(const DrawContext& context, const ShadowPass& shadows, float lift,
                        const Vec3f& albedo) {
    if (count_ == 0) {
        return;
    }
    const Camera& camera = context.camera;
    ShaderProgram& program = programs_.variant(shadows.defines(context, context.lamplit()));
    program.use();
    context.lighting.apply(program, camera.eye);
    context.lighting.apply_mouth(program, context.scene.landmarks());
    shadows.apply(context, program);
    program.set("origin", origin_);
    program.set("view", camera.view());
    program.set("projection", camera.projection(context.viewport.aspect()));
    program.set("to_world", Eigen::Matrix4f(camera.view().inverse()));
    program.set("clip_plane", context.clip_plane);
    program.set("lift", lift);
    program.set("height", static_cast<float>(context.viewport.height));
    program.set("tint", albedo);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    glBindVertexArray(array_.name());
    glDrawArrays(GL_POINTS, 0, count_);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_PROGRAM_POINT_SIZE);
}

}  // namespace eti::render
