// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/draw_context.hpp"
#include "client/render/gl/shader_variants.hpp"
#include "client/render/gl/shadow_map.hpp"
#include "client/render/mesh/scene_meshes.hpp"
#include "client/render/passes/liquid/liquid_surface.hpp"

namespace eti::render {

/// Shadow maps of the room light and the laryngoscope's lamp: tissue, blade and dark drops cast shadows. A
/// map that is still valid is reused: the views and eyes of one state share the lamp's.
class ShadowPass {
  public:
    explicit ShadowPass(const Quality& quality);

    /// Draws the maps that the view's row requires. Runs before begin_passes(): assumes clip distances
    /// off, and leaves another framebuffer and viewport, and culling off.
    void draw(const DrawContext& context, SceneMeshes& meshes, const LiquidSurface& liquid);

    /// Defines for programs that sample these maps in this view. `lamplit`: whether the lamp reaches what
    /// they draw.
    [[nodiscard]] ShaderProgram::Defines defines(const DrawContext& context, bool lamplit) const;
    /// Sets their uniforms; the program must be in use.
    void apply(const DrawContext& context, ShaderProgram& program) const;

  private:
    /// Parameters that differ between the two maps.
    struct Caster {
        const char* define;  ///< for the depth program, or nullptr
        ShadowLod coarse;
        float bias;           ///< [m], for coarse surfaces
        float fine_bias;      ///< [m], for fine surfaces, beyond rounding
        float depth;          ///< [m], depth range of the map
        Eigen::Matrix4f box;  ///< clip volume of possible shadow casters
        const Light* lamp;    ///< lamp whose reach limits the casters, or nullptr
    };
    void fill(ShadowMap& map, const Eigen::Matrix4f& world_to_light, const Caster& caster,
              const DrawContext& context, SceneMeshes& meshes, const LiquidSurface& liquid);

    int taps_, lens_taps_;
    ShadowMap room_, lamp_;
    ShaderVariants depth_, drops_;
};

}  // namespace eti::render
