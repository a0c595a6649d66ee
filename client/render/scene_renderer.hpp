// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/annotation_pass.hpp"
#include "client/render/caps_pass.hpp"
#include "client/render/context_loss.hpp"
#include "client/render/drawing.hpp"
#include "client/render/glottis_pass.hpp"
#include "client/render/liquid_surface.hpp"
#include "client/render/patient_pass.hpp"
#include "client/render/render_target.hpp"
#include "client/render/scene_meshes.hpp"
#include "client/render/shadow_pass.hpp"
#include "client/render/tone_pass.hpp"
#include "client/render/tools_pass.hpp"
#include "client/render/wet_film.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// Draws a SceneView. The context under which it was made must be current.
class SceneRenderer {
  public:
    explicit SceneRenderer(const Quality& quality = affordable_quality());

    /// Takes over the scene's newest state; call SceneView::update() before. Throws std::runtime_error when
    /// the context is lost.
    void sync(const view::SceneView& scene, Baking baking = Baking::wait);

    /// Draws one view into an area of the target's picture: the passes of its row, once for each of its
    /// cameras, and what makes a picture of their light.
    void draw(const View& view, const view::SceneView& scene, const RenderTarget& target,
              const Viewport& area, const Vantage& from = {}, Shading shading = Shading::lit);

    [[nodiscard]] const SceneMeshes& meshes() const { return meshes_; }
    [[nodiscard]] const WetFilm& film() const { return film_; }

  private:
    void run(Pass pass, const Drawing& drawing);

    const Quality& quality_;
    ContextLoss loss_;
    SceneMeshes meshes_;
    ShadowPass shadows_;
    CapsPass caps_;
    PatientPass patient_;
    ToolsPass tools_;
    LiquidSurface liquid_;
    GlottisPass glottis_;
    AnnotationPass annotations_;
    WetFilm film_;
    TonePass tone_;
};

}  // namespace eti::render
