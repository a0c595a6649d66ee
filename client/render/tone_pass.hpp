// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/gl_object.hpp"
#include "client/render/render_target.hpp"
#include "client/render/shader_program.hpp"
#include "client/render/viewport.hpp"
#include "common/math/transform.hpp"

namespace eti::render {

/// How a view's light becomes a picture: what lies between the scene and who looks.
struct ToneMapping {
    float exposure = 1.0f;  ///< factor on the light, before the film's curve
    /// Mean light that exposure brings brighter pictures down to, as cameras do that meter themselves; 0: as
    /// set.
    float metered = 0.0f;
    float vignette = 0.0f;  ///< 0-1: how much darker the edges are, as through a narrow opening
    float fogging = 0.0f;   ///< 0-1: breath on a lens, densest in its middle
};

/// Brings an area of the scene's light into the picture, of the same pixels.
class TonePass {
  public:
    TonePass();

    /// Into the target's picture, through a filmic curve and as sRGB. `background`: the light of what drew
    /// nothing.
    void draw(const RenderTarget& target, const Viewport& area, const ToneMapping& tone,
              const Vec3f& background);
    /// Values as they are: object ids.
    void copy(const RenderTarget& target, const Viewport& area);

  private:
    void cover(ShaderProgram& program, const Texture& light, const Viewport& area);

    ShaderProgram tone_, copy_;
    VertexArray no_attributes_;
};

}  // namespace eti::render
