// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/view/liquid/liquid_foam.hpp"

namespace eti::render {

struct DrawContext;
class ShadowPass;

/// Draws foam on a liquid, one shaded point per bubble.
class FoamRenderer {
  public:
    FoamRenderer();

    /// Eight bytes per bubble.
    void upload(std::span<const view::Bubble> bubbles);

    /// Draws over the bound framebuffer, after the liquid, in the state of begin_passes(); writes no depth.
    /// `lift` [m]: offset from the particles to the visible surface; `albedo`: of light
    /// scattered by the bubbles' films.
    void draw(const DrawContext& context, const ShadowPass& shadows, float lift, const Vec3f& albedo);

  private:
    ShaderVariants programs_;
    VertexArray array_;
    Buffer bubbles_;
    GLsizei count_ = 0;
    Vec3f origin_ = Vec3f::Zero();
};

}  // namespace eti::render
