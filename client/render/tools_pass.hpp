// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/shader_family.hpp"
#include "client/render/shadow_pass.hpp"

namespace eti::render {

/// Laryngoscope and tube.
class ToolsPass {
  public:
    ToolsPass();
    void draw(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows);
    /// The table on which the patient lies.
    void draw_table(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows);
    /// What of them lies behind what was drawn, faintly.
    void draw_hidden(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows);

  private:
    void draw_blade(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows,
                    float opacity);
    void draw_tube(const Drawing& drawing, const SceneMeshes& meshes, const ShadowPass& shadows,
                   float opacity);

    /// The picture as it was before the tube.
    class Behind {
      public:
        void copy(const Viewport& area);
        Texture texture;

      private:
        Framebuffer target_;
        int width_ = 0, height_ = 0;
    };
    void set_refraction(const Drawing& drawing, ShaderProgram& program);

    Behind behind_;
    ShaderFamily metal_, plastic_, cloth_, flat_;
};

}  // namespace eti::render
