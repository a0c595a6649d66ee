// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools_pass.hpp"

#include <string>

#include "client/render/light_shaders.hpp"
#include "client/render/mesh_shaders.hpp"
#include "client/render/tool_shaders.hpp"

namespace eti::render {
namespace {

constexpr float hidden_opacity = 0.22f;
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
    ShaderProgram& program = drawing.ids() ? flat_.with({"TUBE"}) : [&]() -> ShaderProgram& {
        ShaderProgram::Defines defines = shadows.defines(drawing, drawing.lamplit());
        defines.emplace_back("TUBE");
        return plastic_.with(defines);
    }();
    program.use();
    place(program, drawing, Eigen::Matrix4f::Identity(), no_clipping);
    if (drawing.ids()) {
        program.set("flat_colour", flat(tube_colour));
        meshes.tube()->draw();
        return;
    }
    program.set("opacity", opacity);
    program.set("tube_length", drawing.scene.tube()->tube().length);
    drawing.lighting.apply(program, drawing.camera.eye);
    shadows.apply(drawing, program);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    if (opacity == 1.0f) {
        // Far wall first, so that it shows through the near one.
        glDepthMask(GL_FALSE);
        glCullFace(GL_FRONT);
        meshes.tube()->draw();
        glCullFace(GL_BACK);
        glDepthMask(GL_TRUE);
        meshes.tube()->draw();
        glDisable(GL_BLEND);
    } else {
        meshes.tube()->draw();
    }
}

}  // namespace eti::render
