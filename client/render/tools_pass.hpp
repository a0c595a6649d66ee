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

    ShaderFamily metal_, plastic_, cloth_, flat_;
};

}  // namespace eti::render
