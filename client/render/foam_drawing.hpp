// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/render/gl_object.hpp"
#include "client/render/shader_family.hpp"
#include "client/view/liquid_foam.hpp"

namespace eti::render {

struct Drawing;
class ShadowPass;

/// Draws foam on a liquid, a shaded point a bubble.
class FoamDrawing {
  public:
    FoamDrawing();

    /// Eight bytes a bubble.
    void upload(std::span<const view::Bubble> bubbles);

    /// Over the bound framebuffer, after the liquid. `lift` [m] from the particles to the surface that is
    /// seen; `liquid` is what that scatters back, and shells have its colour.
    void draw(const Drawing& drawing, const ShadowPass& shadows, float lift, const Vec3f& liquid);

  private:
    ShaderFamily programs_;
    VertexArray array_;
    Buffer bubbles_;
    GLsizei count_ = 0;
    Vec3f origin_ = Vec3f::Zero();
};

}  // namespace eti::render
