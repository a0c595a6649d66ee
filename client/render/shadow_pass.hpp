// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/shadow_map.hpp"

namespace eti::render {

/// The shadow maps of the room's light and of the laryngoscope's lamp. A map that is still right is kept:
/// views and eyes of one state share the lamp's.
class ShadowPass {
  public:
    explicit ShadowPass(const Quality& quality);

    /// Draws those maps that the view's row names; leaves another framebuffer bound.
    void draw(const Drawing& drawing, SceneMeshes& meshes);

    /// What programs that look into these maps for this view are made with.
    /// `lamplit`: whether the lamp reaches what they draw.
    [[nodiscard]] ShaderProgram::Defines defines(const Drawing& drawing, bool lamplit) const;
    /// Sets what they need; the program must be in use.
    void apply(const Drawing& drawing, ShaderProgram& program) const;

  private:
    void fill(ShadowMap& map, const Eigen::Matrix4f& clip, const Drawing& drawing, SceneMeshes& meshes,
              Coarse coarse, bool lips_aside);

    int taps_;
    ShadowMap room_, lamp_;
    ShaderProgram depth_, depth_retracted_;
};

}  // namespace eti::render
