// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "client/render/draw_context.hpp"
#include "client/render/gl/context_loss.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/mesh/scene_meshes.hpp"
#include "client/render/passes/annotation_pass.hpp"
#include "client/render/passes/caps_pass.hpp"
#include "client/render/passes/glottis_pass.hpp"
#include "client/render/passes/liquid/liquid_surface.hpp"
#include "client/render/passes/liquid/wet_film.hpp"
#include "client/render/passes/patient_pass.hpp"
#include "client/render/passes/room_pass.hpp"
#include "client/render/passes/shadow_pass.hpp"
#include "client/render/passes/tone_pass.hpp"
#include "client/render/passes/tools_pass.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// Draws a SceneView. The context current at construction must be current in every call.
class SceneRenderer {
  public:
    explicit SceneRenderer(const Quality& quality = affordable_quality());

    /// Uploads the scene's latest state; call SceneView::update() first. Throws std::runtime_error when the
    /// context is lost.
    void sync(const view::SceneView& scene, Baking baking = Baking::wait);

    /// Draws one view into an area of the target's picture: the passes of its row, once per camera, then
    /// tone mapping.
    void draw(const View& view, const view::SceneView& scene, const RenderTarget& target,
              const Viewport& area, const Vantage& from = {}, Shading shading = Shading::lit);

    [[nodiscard]] const SceneMeshes& meshes() const { return meshes_; }
    [[nodiscard]] const WetFilm& film() const { return film_; }

  private:
    void run(Pass pass, const DrawContext& context);

    const Quality& quality_;
    ContextLossMonitor loss_;
    SceneMeshes meshes_;
    ShadowPass shadows_;
    std::optional<EnvironmentMap> environment_;
    CapsPass caps_;
    PatientPass patient_;
    RoomPass room_;
    ToolsPass tools_;
    LiquidSurface liquid_;
    GlottisPass glottis_;
    AnnotationPass annotations_;
    WetFilm film_;
    TonePass tone_;
};

}  // namespace eti::render
