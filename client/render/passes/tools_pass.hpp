// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/draw_context.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/render/mesh/scene_meshes.hpp"
#include "client/render/passes/shadow_pass.hpp"

namespace eti::render {

/// Laryngoscope and tube. GL state of each function: begin_passes(); samples the maps of the last
/// ShadowPass::draw(). Run draw() after the other opaque passes, which the tube blends with or refracts, and
/// draw_hidden(), which reads their depth and writes none, after it.
class ToolsPass {
  public:
    ToolsPass();
    void draw(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows);
    /// Draws occluded parts of the tools faintly.
    void draw_hidden(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows);

  private:
    void draw_blade(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows,
                    float opacity);
    void draw_tube(const DrawContext& context, const SceneMeshes& meshes, const ShadowPass& shadows,
                   float opacity);

    /// Copy of the picture before the tube is drawn.
    class Backdrop {
      public:
        void copy(const Viewport& area);
        Texture texture;

      private:
        Framebuffer target_;
        int width_ = 0, height_ = 0;
    };
    void set_refraction(const DrawContext& context, ShaderProgram& program);
    /// Sets what the tube's print and Murphy's eye need.
    void set_print(ShaderProgram& program, const Tube& tube);
    void draw_bulb(const DrawContext& context, const SceneMeshes& meshes, const Eigen::Matrix4f& pose);

    Backdrop backdrop_;
    ShaderVariants metal_, plastic_, flat_, glow_;
    Texture numerals_;
};

}  // namespace eti::render
