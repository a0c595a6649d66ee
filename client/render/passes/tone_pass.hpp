// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/views/viewport.hpp"
#include "common/math/transform.hpp"

namespace eti::render {

/// Tone mapping of a view: from scene light to picture.
struct ToneMapping {
    float exposure = 1.0f;  ///< factor on the light, before the filmic curve
    /// Mean light to which automatic exposure reduces brighter pictures; 0: fixed exposure.
    float metered = 0.0f;
    float vignette = 0.0f;  ///< 0-1: darkening towards the edges, as through a narrow opening
    float fogging = 0.0f;   ///< 0-1: fogged lens, densest in the centre
};

/// Tone-maps an area of the scene's light into the same pixels of the picture. Runs after the passes: assumes
/// scissor and stencil test off, and leaves the picture bound, the viewport at the area, and depth test,
/// blending and culling off.
class TonePass {
  public:
    TonePass();

    /// Draws into the target's picture with a filmic curve and sRGB encoding. `background`: light of pixels
    /// that nothing covers.
    void draw(const RenderTarget& target, const Viewport& area, const ToneMapping& tone,
              const Vec3f& background);
    /// Copies values unchanged, for object ids.
    void copy(const RenderTarget& target, const Viewport& area);

  private:
    void cover(ShaderProgram& program, const Texture& light, const Viewport& area);

    ShaderProgram tone_, copy_;
    VertexArray no_attributes_;
};

}  // namespace eti::render
