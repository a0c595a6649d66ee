// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/app/headset/laser_pointer.hpp"
#include "client/hud/hud.hpp"
#include "client/hud/readout.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Draws a headset's pictures: one per eye, and a quad with the readout. Only marks are drawn over the
/// eyes' pictures, each at the depth of what it marks, so that both eyes can fuse it.
class EyeCompositor {
  public:
    static constexpr int readout_width = 768, readout_height = 448;

    EyeCompositor(int eye_width, int eye_height, const render::Quality& quality);

    /// Draws both eyes side by side into stereo(), with the session's aids. `shown`: whether there is a
    /// patient to draw. `rays`: in the patient frame.
    void draw_eyes(const view::SceneView& scene, const render::Vantage& from, bool shown,
                   std::span<const LaserRay> rays = {});
    /// Draws the readout into readout_picture(), transparent where it is empty.
    void draw_readout(const hud::Readout& readout);

    /// See Hud::set_text_scale().
    void set_text_scale(float scale) { hud_.set_text_scale(scale); }

    /// Whether the patient is ready to draw: a new patient's colours are first computed in the background.
    [[nodiscard]] bool has_patient() const { return renderer_.meshes().ready(); }
    /// Waits until the GPU has finished drawing.
    void finish() const;
    /// Copies the left eye's picture into framebuffer 0, a window of this size, scaled to fit.
    void mirror(int width, int height) const;

    [[nodiscard]] const render::RenderTarget& stereo() const { return stereo_; }
    [[nodiscard]] const render::RenderTarget& readout_picture() const { return readout_picture_; }

  private:
    render::RenderTarget stereo_, readout_picture_;
    render::SceneRenderer renderer_;
    hud::Hud hud_;
};

}  // namespace eti::client
