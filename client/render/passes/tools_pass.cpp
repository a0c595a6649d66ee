// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/tools_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "client/render/gl/render_target.hpp"
#include "client/render/shaders/shaders.hpp"
#include "client/render/tools/numerals.hpp"
#include "common/math/units.hpp"

namespace eti::render {
namespace {

constexpr float hidden_opacity = 0.22f;
constexpr int behind_unit = 5;                          // shadow maps use the units before it
constexpr int numerals_unit = 13;                       // after the environment's
const Eigen::Vector4f glowing(2.6f, 2.4f, 2.1f, 1.0f);  // linear light of the lamp's glass
// The halo's size relative to the glass, and its brightness in the middle relative to the glass.
constexpr float halo_size = 3.0f, halo_light = 0.2f;

}  // namespace

ToolsPass::ToolsPass()
    : metal_("metal", shaders::mesh_vertex, shaders::metal_fragment),
      plastic_("tube", shaders::mesh_vertex, shaders::tube_fragment),
      flat_("flat tool", shaders::mesh_vertex, shaders::flat_fragment),
      glow_("glow", shaders::mesh_vertex, shaders::glow_fragment) {
    const NumeralAtlas& atlas = numeral_atlas();
    glBindTexture(GL_TEXTURE_2D, numerals_.name());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, atlas.width, atlas.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                 atlas.texels.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    set_filter(GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    }
}

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
    const Eigen::Matrix4f pose = matrix_of(*context.scene.laryngoscope_pose());
    // Visibility is measured with a blade without bulb and details, and so are pictures for measurement.
    if (context.ids()) {
        ShaderProgram& program = flat_.variant({});
        program.use();
        place(program, context, pose, no_clipping);
        program.set("flat_colour", flat(blade_colour));
        meshes.blade()->draw();
        return;
    }
    const auto use = [&](bool knurl) {
        ShaderProgram::Defines defines = shadows.defines(context, context.lamplit());
        if (knurl) {
            defines.emplace_back("DETAILS");
        }
        ShaderProgram& program = metal_.variant(defines);
        program.use();
        place(program, context, pose, no_clipping);
        program.set("opacity", opacity);
        context.lighting.apply(program, context.camera.eye);
        shadows.apply(context, program);
    };
    use(false);
    meshes.blade()->draw();
    if (context.quality.fine) {
        use(true);
    }
    meshes.blade_details()->draw();
    if (opacity == 1.0f) {
        draw_bulb(context, meshes, pose);
    }
}

void ToolsPass::draw_bulb(const DrawContext& context, const SceneMeshes& meshes,
                          const Eigen::Matrix4f& pose) {
    ShaderProgram& glass = flat_.variant({});
    glass.use();
    place(glass, context, pose, no_clipping);
    glass.set("flat_colour", glowing);
    meshes.bulb()->draw();
    const Eigen::Translation3f centre(bulb_centre(context.scene.keys()->laryngoscope().blade_length));
    ShaderProgram& halo = glow_.variant({});
    halo.use();
    place(halo, context,
          Eigen::Matrix4f(pose *
                          (centre * Eigen::UniformScaling<float>(halo_size) * centre.inverse()).matrix()),
          no_clipping);
    halo.set("eye", context.camera.eye);
    halo.set("glow", Vec3f(halo_light * glowing.head<3>()));
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glDepthMask(GL_FALSE);
    meshes.bulb()->draw();
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

void ToolsPass::set_print(ShaderProgram& program, const Tube& tube) {
    const float tenths = std::round(10.0f * tube.inner_diameter / millimetre);
    program.set("tube_length", tube.length);
    program.set("circumference", std::numbers::pi_v<float> * tube.outer_diameter);
    program.set("printed_size", Eigen::Vector2f(std::floor(tenths / 10.0f), std::fmod(tenths, 10.0f)));
    // Murphy's eye has at least 80 % of the lumen's area (ISO 5361), and lies past the bevel.
    program.set("murphy_eye",
                Vec3f(1.5f * tube.outer_diameter, 0.6f * tube.inner_diameter, 0.36f * tube.inner_diameter));
    program.set("numeral_cell", Eigen::Vector4f(NumeralAtlas::margin_left, NumeralAtlas::margin_below,
                                                NumeralAtlas::cell_span * NumeralAtlas::cell_width /
                                                    NumeralAtlas::cell_height,
                                                NumeralAtlas::cell_span));
    program.set("numerals", numerals_unit);
    glActiveTexture(GL_TEXTURE0 + numerals_unit);
    glBindTexture(GL_TEXTURE_2D, numerals_.name());
    glActiveTexture(GL_TEXTURE0);
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
        meshes.tube()->draw();  // the connector is only drawn, as the blade's details are
        return;
    }
    const auto use = [&](std::initializer_list<const char*> more) -> ShaderProgram& {
        ShaderProgram::Defines defines = shadows.defines(context, context.lamplit());
        defines.insert(defines.end(), more.begin(), more.end());
        ShaderProgram& program = plastic_.variant(defines);
        program.use();
        place(program, context, Eigen::Matrix4f::Identity(), no_clipping);
        program.set("opacity", opacity);
        set_print(program, context.scene.tube()->tube());
        context.lighting.apply(program, context.camera.eye);
        shadows.apply(context, program);
        return program;
    };
    const bool whole = opacity == 1.0f, refracts = whole && context.quality.refraction;
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    place(use({"TUBE"}), context, matrix_of(context.scene.tube()->connector_pose()), no_clipping);
    meshes.connector()->draw();
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
