// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/drawing.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/shader_family.hpp"
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
    /// What tells its two maps apart.
    struct Caster {
        const char* define;  ///< of the depth program, or nullptr
        Coarse coarse;
        float bias;           ///< [m], of coarse surfaces
        float depth;          ///< [m], what the map spans
        Eigen::Matrix4f box;  ///< clip coordinates of what may throw a shadow into it
        const Light* lamp;    ///< whose reach that is, or nullptr
    };
    void fill(ShadowMap& map, const Eigen::Matrix4f& into_light, const Caster& caster, const Drawing& drawing,
              SceneMeshes& meshes);

    int taps_, lens_taps_;
    ShadowMap room_, lamp_;
    ShaderFamily depth_;
};

}  // namespace eti::render
