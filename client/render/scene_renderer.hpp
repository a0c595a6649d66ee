// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

#include "client/render/liquid_surface.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/section_cut.hpp"
#include "client/render/shader_program.hpp"
#include "client/render/shadow_map.hpp"
#include "client/render/view_table.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// Pixels from the picture's lower left corner.
struct Viewport {
    int x = 0, y = 0, width = 640, height = 480;
};

enum class Shading : std::uint8_t {
    lit,
    object_id,  ///< each object in one flat colour, see object_colour(); for measuring what is seen
};

/// Stable colours of Shading::object_id, 8 bits a channel.
[[nodiscard]] std::array<std::uint8_t, 3> object_colour(Tissue tissue);
inline constexpr std::array<std::uint8_t, 3> blade_colour{0, 255, 0};
inline constexpr std::array<std::uint8_t, 3> tube_colour{0, 0, 255};

/// Draws a SceneView. The context under which it was made must be current.
class SceneRenderer {
  public:
    SceneRenderer();

    /// Takes over the scene's newest shape; call SceneView::update() before.
    void sync(const view::SceneView& scene);

    /// Draws one view into the bound framebuffer, which has depth and stencil.
    void draw(const View& view, const view::SceneView& scene, const Viewport& viewport,
              const Vantage& from = {}, Shading shading = Shading::lit);

  private:
    struct Drawing;  // what one draw() needs throughout
    [[nodiscard]] ShaderProgram& skin_program(const Drawing& drawing);
    void draw_skin(const Drawing& drawing);
    void draw_caps(const Drawing& drawing);
    void draw_cap(const Drawing& drawing, SurfaceMesh& surface);
    void draw_tools(const Drawing& drawing, float opacity);
    void draw_shadows(const Drawing& drawing);
    void draw_liquid(const Drawing& drawing);
    void draw_vignette(const Drawing& drawing);

    SceneMeshes meshes_;
    ShaderProgram tissue_, tissue_shadowed_, tissue_retracted_, metal_, tube_, flat_, flat_retracted_,
        flat_tube_, cut_, vignette_;
    CutMesh cut_mesh_;
    LiquidSurface liquid_;
    ShadowMap shadow_map_;
    VertexArray no_attributes_;
};

}  // namespace eti::render
