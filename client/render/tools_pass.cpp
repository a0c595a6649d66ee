// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools_pass.hpp"

#include <algorithm>
#include <string>

#include "client/render/light_shaders.hpp"
#include "client/render/mesh_shaders.hpp"
#include "client/render/render_target.hpp"
#include "client/render/tool_shaders.hpp"

namespace eti::render {
namespace {

constexpr float hidden_opacity = 0.22f;
constexpr int behind_unit = 5;                          // shadow maps have those before
const Eigen::Vector4f glowing(2.6f, 2.4f, 2.1f, 1.0f);  // linear light of the lamp's glass

std::string lit(std::string_view body) {
    return std::string(source::mesh_inputs) + source::lighting + std::string(body);
}

}  // namespace

ToolsPass::ToolsPass()
    : metal_("metal", std::string(source::mesh_vertex), lit(source::metal_fragment)),
      plastic_("tube", std::string(source::mesh_vertex), lit(source::tube_fragment)),
      cloth_("cloth", std::string(source::lights) + std::string(source::cloth_vertex),
             "in vec3 world;\n" + source::lighting + std::string(source::cloth_fragment)),
      flat_("flat tool", std::string(source::mesh_vertex), std::string(source::flat_fragment)) {}

void ToolsPass::draw(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows) {
    draw_blade(drawing, meshes, shadows, 1.0f);
    draw_tube(drawing, meshes, shadows, 1.0f);
}

void ToolsPass::draw_hidden(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows) {
    if (drawing.ids()) {
        return;
    }
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    draw_blade(drawing, meshes, shadows, hidden_opacity);
    draw_tube(drawing, meshes, shadows, hidden_opacity);
    glDisable(GL_BLEND);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
}

void ToolsPass::draw_blade(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows,
                           float opacity) {
    if (!meshes.blade() || !drawing.scene.laryngoscope_pose()) {
        return;
    }
    ShaderProgram& program =
        drawing.ids() ? flat_.with({}) : metal_.with(shadows.defines(drawing, drawing.lamplit()));
    program.use();
    place(program, drawing, matrix_of(*drawing.scene.laryngoscope_pose()), no_clipping);
    if (drawing.ids()) {
        program.set("flat_colour", flat(blade_colour));
    } else {
        program.set("opacity", opacity);
        drawing.lighting.apply(program, drawing.camera.eye);
        shadows.apply(drawing, program);
    }
    meshes.blade()->draw();
    // The measured view knows the blade without its bulb, and so do pictures that are measured.
    if (meshes.bulb() && opacity == 1.0f && !drawing.ids()) {
        ShaderProgram& glass = flat_.with({});
        glass.use();
        place(glass, drawing, matrix_of(*drawing.scene.laryngoscope_pose()), no_clipping);
        glass.set("flat_colour", drawing.ids() ? flat(blade_colour) : glowing);
        meshes.bulb()->draw();
    }
}

void ToolsPass::draw_table(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows) {
    if (drawing.ids() || !meshes.table()) {
        return;
    }
    ShaderProgram::Defines defines = shadows.defines(drawing, false);
    if (drawing.quality.fine) {
        defines.emplace_back("FINE");
    }
    ShaderProgram& program = cloth_.with(defines);
    program.use();
    place(program, drawing, Eigen::Matrix4f::Identity(), drawing.clip_plane);
    drawing.lighting.apply(program, drawing.camera.eye);
    shadows.apply(drawing, program);
    meshes.table()->draw();
}

void ToolsPass::draw_tube(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows,
                          float opacity) {
    if (!meshes.tube()) {
        return;
    }
    if (drawing.ids()) {
        ShaderProgram& program = flat_.with({"TUBE"});
        program.use();
        place(program, drawing, Eigen::Matrix4f::Identity(), no_clipping);
        program.set("flat_colour", flat(tube_colour));
        meshes.tube()->draw();
        return;
    }
    const auto use = [&](std::initializer_list<const char*> more) -> ShaderProgram& {
        ShaderProgram::Defines defines = shadows.defines(drawing, drawing.lamplit());
        defines.insert(defines.end(), more.begin(), more.end());
        ShaderProgram& program = plastic_.with(defines);
        program.use();
        place(program, drawing, Eigen::Matrix4f::Identity(), no_clipping);
        program.set("opacity", opacity);
        program.set("tube_length", drawing.scene.tube()->tube().length);
        drawing.lighting.apply(program, drawing.camera.eye);
        shadows.apply(drawing, program);
        return program;
    };
    const bool whole = opacity == 1.0f, refracts = whole && drawing.quality.refraction;
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (whole) {
        // Far wall first, so that it shows through the near one.
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
        behind_.copy(drawing.viewport);
        set_refraction(drawing, use({"TUBE", "REFRACT"}));
    } else {
        use({"TUBE"});
    }
    meshes.tube()->draw();
    if (whole) {
        glDisable(GL_BLEND);
    }
}

/// Copies what the bound framebuffer shows, its samples averaged.
void ToolsPass::Behind::copy(const Viewport& area) {
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    const int right = area.x + area.width, top = area.y + area.height;
    if (right > width_ || top > height_) {
        width_ = std::max(width_, right);
        height_ = std::max(height_, top);
        glActiveTexture(GL_TEXTURE0);
        store_light(texture, target_, width_, height_);
    }
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(bound));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.name());
    glBlitFramebuffer(area.x, area.y, right, top, area.x, area.y, right, top, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(bound));
}

void ToolsPass::set_refraction(const Drawing& drawing, ShaderProgram& program) {
    const Viewport& area = drawing.viewport;
    const Tube& tube = drawing.scene.tube()->tube();
    const float pixels =
        0.5f * static_cast<float>(area.height) * drawing.camera.projection(area.aspect())(1, 1);
    program.set("view", drawing.camera.view());
    program.set("wall", Vec3f(tube.outer_radius(), tube.inner_radius() / tube.outer_radius(), pixels));
    program.set("behind_area", Eigen::Vector4f(static_cast<float>(area.x), static_cast<float>(area.y),
                                               static_cast<float>(area.x + area.width - 1),
                                               static_cast<float>(area.y + area.height - 1)));
    program.set("behind", behind_unit);
    glActiveTexture(GL_TEXTURE0 + behind_unit);
    glBindTexture(GL_TEXTURE_2D, behind_.texture.name());
    glActiveTexture(GL_TEXTURE0);
}

}  // namespace eti::render
