// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/tools_pass.hpp"

#include <algorithm>
#include <string>

#include "client/render/gl/render_target.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti::render {
namespace {

constexpr float hidden_opacity = 0.22f;
constexpr int behind_unit = 5;                          // shadow maps use the units before it
const Eigen::Vector4f glowing(2.6f, 2.4f, 2.1f, 1.0f);  // linear light of the lamp's glass

}  // namespace

ToolsPass::ToolsPass()
    : metal_("metal", shaders::mesh_vertex, shaders::metal_fragment),
      plastic_("tube", shaders::mesh_vertex, shaders::tube_fragment),
      flat_("flat tool", shaders::mesh_vertex, shaders::flat_fragment) {}

void ToolsPass::draw(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows) {
    draw_blade(context, meshes, shadows, 1.0f);
    draw_tube(context, meshes, shadows, 1.0f);
}

void ToolsPass::draw_hidden(const DrawContext& context, const SceneMeshes& meshes,
                            const ShadowPass& shadows) {
    if (context.ids()) {
        return;
    }
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    draw_blade(context, meshes, shadows, hidden_opacity);
    draw_tube(context, meshes, shadows, hidden_opacity);
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
}

void ToolsPass::draw_blade(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows,
                           float opacity) {
    if (!meshes.blade() || !context.scene.laryngoscope_pose()) {
        return;
    }
    ShaderProgram& program =
        context.ids() ? flat_.variant({}) : metal_.variant(shadows.defines(context, context.lamplit()));
    program.use();
    place(program, context, matrix_of(*context.scene.laryngoscope_pose()), no_clipping);
    if (context.ids()) {
        program.set("flat_colour", flat(blade_colour));
    } else {
        program.set("opacity", opacity);
        context.lighting.apply(program, context.camera.eye);
        shadows.apply(context, program);
    }
    meshes.blade()->draw();
    // Visibility is measured with a blade without a bulb, and so are pictures for measurement.
    if (meshes.bulb() && opacity == 1.0f && !context.ids()) {
        ShaderProgram& glass = flat_.variant({});
        glass.use();
        place(glass, context, matrix_of(*context.scene.laryngoscope_pose()), no_clipping);
        glass.set("flat_colour", context.ids() ? flat(blade_colour) : glowing);
        meshes.bulb()->draw();
    }
}

void ToolsPass::draw_tube(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows,
                          float opacity) {
    if (!meshes.tube()) {
        return;
    }
    if (context.ids()) {
        ShaderProgram& program = flat_.variant({"TUBE"});
        program.use();
        place(program, context, Eigen::Matrix4f::Identity(), no_clipping);
        program.set("flat_colour", flat(tube_colour));
        meshes.tube()->draw();
        return;
    }
    const auto use = [&](std::initializer_list<const char*> more) -> ShaderProgram& {
        ShaderProgram::Defines defines = shadows.defines(context, context.lamplit());
        defines.insert(defines.end(), more.begin(), more.end());
        ShaderProgram& program = plastic_.variant(defines);
        program.use();
        place(program, context, Eigen::Matrix4f::Identity(), no_clipping);
        program.set("opacity", opacity);
        program.set("tube_length", context.scene.tube()->tube().length);
        context.lighting.apply(program, context.camera.eye);
        shadows.apply(context, program);
        return program;
    };
    const bool whole = opacity == 1.0f, refracts = whole && context.quality.refraction;
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (whole) {
        // Far wall first, so that it is visible through the near one.
        if (refracts) {
            use({"TUBE", "FAR"});
        } else {
            use({"TUBE"});
        }
        glDepthMask(GL_FALSE);
        glCullFace(GL_FRONT);
        meshes.tube()->draw();
        glCullFace(GL_BACK);
        glDepthMask(GL_TRUE);
    }
    if (refracts) {
        glDisable(GL_BLEND);
        backdrop_.copy(context.viewport);
        set_refraction(context, use({"TUBE", "REFRACT"}));
    } else {
        use({"TUBE"});
    }
    meshes.tube()->draw();
    if (whole) {
        glDisable(GL_BLEND);
    }
}

/// Copies the bound framebuffer, resolving its samples.
void ToolsPass::Backdrop::copy(const Viewport& area) {
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    const int right = area.x + area.width, top = area.y + area.height;
    if (right > width_ || top > height_) {
        width_ = std::max(width_, right);
        height_ = std::max(height_, top);
        glActiveTexture(GL_TEXTURE0);
        allocate_hdr_target(texture, target_, width_, height_);
    }
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(bound));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.name());
    glBlitFramebuffer(area.x, area.y, right, top, area.x, area.y, right, top, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

void ToolsPass::set_refraction(const DrawContext& context, ShaderProgram& program) {
    const Viewport& area = context.viewport;
    const Tube& tube = context.scene.tube()->tube();
    const float pixels =
        0.5f * static_cast<float>(area.height) * context.camera.projection(area.aspect())(1, 1);
    program.set("view", context.camera.view());
    program.set("wall", Vec3f(tube.outer_radius(), tube.inner_radius() / tube.outer_radius(), pixels));
    program.set("behind_area", Eigen::Vector4f(static_cast<float>(area.x), static_cast<float>(area.y),
                                               static_cast<float>(area.x + area.width - 1),
                                               static_cast<float>(area.y + area.height - 1)));
    program.set("behind", behind_unit);
    glActiveTexture(GL_TEXTURE0 + behind_unit);
    glBindTexture(GL_TEXTURE_2D, backdrop_.texture.name());
    glActiveTexture(GL_TEXTURE0);
}

}  // namespace eti::render
