// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/app/window/selection.hpp"
#include "client/hud/hud.hpp"
#include "client/hud/readout.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// A view's place in a picture; pixels from the upper left.
struct PlacedView {
    const render::View* view;
    hud::Tile tile;
};
[[nodiscard]] std::vector<PlacedView> layout(const Views& views, int width, int height,
                                             Arrangement arrangement = Arrangement::first_large);

/// The view of a selection at a pixel, with its place.
[[nodiscard]] std::optional<PlacedView> placed_at(const Selection& selection, const view::SceneView& scene,
                                                  int width, int height, float x, float y);

/// Time spent drawing a view [ms], including waiting for the driver.
struct DrawTime {
    double sum_ms = 0.0;
    std::uint64_t frames = 0;

    [[nodiscard]] double mean_ms() const { return frames > 0 ? sum_ms / static_cast<double>(frames) : 0.0; }
    void add(std::chrono::steady_clock::time_point since) {
        sum_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
        ++frames;
    }
};

/// Draws whole pictures: views side by side with the readout on top.
class Compositor {
  public:
    Compositor(int width, int height, const render::Quality& quality);

    /// Draws into target(), with the learner's aids if the session requests the enhanced view. Without
    /// views only the readout is drawn. `measured`: waits after each view to time it.
    void draw(const Views& views, const view::SceneView& scene, const hud::Readout& readout,
              const render::Vantage& from, bool measured, Arrangement arrangement = Arrangement::first_large);
    /// Prepares a new scene in the background and shows nothing of it until ready; otherwise draw() waits
    /// for it.
    void bake_in_background() { baking_ = render::Baking::in_background; }
    /// See Hud::set_text_scale().
    void set_text_scale(float scale) { hud_.set_text_scale(scale); }
    [[nodiscard]] const hud::Hud& overlay() const { return hud_; }

    [[nodiscard]] const render::RenderTarget& target() const { return target_; }
    [[nodiscard]] const render::Quality& quality() const { return *quality_; }
    /// Takes effect immediately; recreates all GPU resources.
    void set_quality(const render::Quality& quality);
    void resize(int width, int height);
    /// Time to upload the scene's state to the GPU.
    [[nodiscard]] const DrawTime& sync_time() const { return sync_time_; }
    /// In the order of render::views().
    [[nodiscard]] const std::vector<DrawTime>& times() const { return times_; }

  private:
    const render::Quality* quality_;
    render::Baking baking_ = render::Baking::wait;
    render::RenderTarget target_;
    std::optional<render::SceneRenderer> renderer_;
    hud::Hud hud_;
    DrawTime sync_time_;
    std::vector<DrawTime> times_;
};

}  // namespace eti::client
