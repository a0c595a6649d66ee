// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "client/app/selection.hpp"
#include "client/hud/hud.hpp"
#include "client/hud/readout.hpp"
#include "client/render/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Where a view lies in a picture; pixels from the upper left.
struct PlacedView {
    const render::View* view;
    hud::Tile tile;
};
/// The first view takes the larger part, the others stand beside it one above the other.
[[nodiscard]] std::vector<PlacedView> layout(const Views& views, int width, int height);

/// Milliseconds spent drawing a view, waiting for the driver included.
struct DrawTime {
    double sum_ms = 0.0;
    std::uint64_t frames = 0;
};

/// Draws whole pictures: views side by side with the readout over them.
class Compositor {
  public:
    Compositor(int width, int height, int samples);

    /// The picture is then in target(), with what helps a learner where the session asks for the enhanced
    /// view. `measured`: waits after each view to time it.
    void draw(const Views& views, const view::SceneView& scene, const hud::Readout& readout,
              const render::Vantage& vantage, bool measured);

    [[nodiscard]] const render::RenderTarget& target() const { return target_; }
    void resize(int width, int height);
    /// In the order of render::views().
    [[nodiscard]] const std::vector<DrawTime>& times() const { return times_; }

  private:
    int samples_;
    render::RenderTarget target_;
    render::SceneRenderer renderer_;
    hud::Hud hud_;
    std::vector<DrawTime> times_;
};

/// Samples a pixel that this driver can afford: 1 for software, 4 else.
[[nodiscard]] int affordable_samples();

}  // namespace eti::client
