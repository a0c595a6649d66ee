// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tone_pass.hpp"

#include "client/render/tone_shaders.hpp"

namespace eti::render {

TonePass::TonePass()
    : tone_("tone mapping", {}, source::quad_vertex, source::tone_fragment),
      copy_("copy", {"COPY"}, source::quad_vertex, source::tone_fragment) {}

void TonePass::cover(ShaderProgram& program, const Texture& light, const Viewport& area) {
    glViewport(area.x, area.y, area.width, area.height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    program.set("light", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, light.name());
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    // The scene is drawn into this texture next.
    glBindTexture(GL_TEXTURE_2D, 0);
    glBindVertexArray(0);
}

void TonePass::draw(const Texture& light, const Viewport& area, const ToneMapping& tone) {
    glEnable(GL_FRAMEBUFFER_SRGB);
    tone_.use();
    tone_.set("aspect", area.aspect());
    tone_.set("exposure", tone.exposure);
    tone_.set("vignette", tone.vignette);
    tone_.set("fogging", tone.fogging);
    cover(tone_, light, area);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

void TonePass::copy(const Texture& light, const Viewport& area) {
    copy_.use();
    cover(copy_, light, area);
}

}  // namespace eti::render
