// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/hud/hud.hpp"
#include "client/hud/readout.hpp"
#include "client/render/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Draws what a headset shows: a picture for each eye, and a sheet with the readout. Over the eyes' pictures
/// only marks are drawn: each lies as far away as what it marks, where eyes settle on both.
class EyeCompositor {
  public:
    static constexpr int sheet_width = 768, sheet_height = 448;

    EyeCompositor(int eye_width, int eye_height, const render::Quality& quality);

    /// A line [m] in the patient frame: what a hand points with.
    struct Ray {
        Vec3f from, to;
    };

    /// Both eyes are then in both(), side by side, with the session's aids. `shown`: there is a patient to be
    /// seen.
    void draw_eyes(const view::SceneView& scene, const render::Vantage& from, bool shown,
                   std::span<const Ray> rays = {});
    /// The readout is then in sheet(), clear where it says nothing.
    void draw_sheet(const hud::Readout& readout);

    /// Whether what is drawn has a patient: a new one's colours are computed beside the drawing first.
    [[nodiscard]] bool has_patient() const { return renderer_.meshes().ready(); }
    /// Waits until all of it is drawn.
    void finish() const;
    /// The left eye's picture into framebuffer 0, a window of this size, as large as it fits.
    void mirror(int width, int height) const;

    [[nodiscard]] const render::RenderTarget& both() const { return both_; }
    [[nodiscard]] const render::RenderTarget& sheet() const { return sheet_; }

  private:
    render::RenderTarget both_, sheet_;
    render::SceneRenderer renderer_;
    hud::Hud hud_;
};

}  // namespace eti::client
