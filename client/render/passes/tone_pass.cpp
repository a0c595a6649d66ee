// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/tone_pass.hpp"

#include "client/render/shaders/shaders.hpp"

#include <string>

namespace eti::render {
namespace {

// Same as film() in the shader.
Vec3f filmic_curve(const Vec3f& light) {
    const Eigen::Array3f c = light.array();
    return (c * (2.51f * c + 0.03f) / (c * (2.43f * c + 0.59f) + 0.14f)).min(1.0f).max(0.0f).matrix();
}

}  // namespace

TonePass::TonePass()
    : tone_("tone mapping", {"TONE"}, shaders::quad_vertex, shaders::tone_fragment),
      copy_("copy", {}, shaders::quad_vertex, shaders::tone_fragment) {}

void TonePass::cover(ShaderProgram& program, const Texture& light, const Viewport& area) {
    glViewport(area.x, area.y, area.width, area.height);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    program.set("light", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, light.name());
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    // The next scene is drawn into this texture.
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindVertexArray(0);
}

void TonePass::draw(const RenderTarget& target, const Viewport& area, const ToneMapping& tone,
                    const Vec3f& background) {
    target.bind_picture();
    glEnable(GL_FRAMEBUFFER_SRGB);
    // In views that are mostly background a software rasteriser saves half of this pass: the background is
    // cleared, and the pass, at the far plane, covers only pixels with nearer geometry.
    const bool uniform =
        target.picture_has_depth() && tone.vignette == 0.0f && tone.fogging == 0.0f && tone.metered == 0.0f;
    if (uniform) {
        const Vec3f plain = filmic_curve(tone.exposure * background);
        glEnable(GL_SCISSOR_TEST);
        glScissor(area.x, area.y, area.width, area.height);
        glClearColor(plain.x(), plain.y(), plain.z(), 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        glDisable(GL_SCISSOR_TEST);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GREATER);
        glDepthMask(GL_FALSE);
    } else {
        glDisable(GL_DEPTH_TEST);
    }
    tone_.use();
    tone_.set("aspect", area.aspect());
    tone_.set("area",
              Eigen::Vector4f(Eigen::Vector4i(area.x, area.y, area.width, area.height).cast<float>()));
    tone_.set("exposure", tone.exposure);
    tone_.set("metered", tone.metered);
    tone_.set("vignette", tone.vignette);
    tone_.set("fogging", tone.fogging);
    cover(tone_, target.light(), area);
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

void TonePass::copy(const RenderTarget& target, const Viewport& area) {
    target.bind_picture();
    glDisable(GL_DEPTH_TEST);
    copy_.use();
    cover(copy_, target.light(), area);
}

}  // namespace eti::render
