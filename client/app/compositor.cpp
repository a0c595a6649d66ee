// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/compositor.hpp"

#include <chrono>
#include <string>

#include "client/render/headless_context.hpp"

namespace eti::client {

std::string_view name_of(Selection selection) {
    return selection == Selection::all ? std::string_view("all")
                                       : render::view_names[static_cast<std::size_t>(selection)];
}

std::vector<PlacedView> layout(Selection selection, int width, int height) {
    using render::View;
    const auto whole = [&](View view) { return PlacedView{view, {name_of(view), 0, 0, width, height}}; };
    if (selection != Selection::all) {
        return {whole(static_cast<View>(selection))};
    }
    // What the operator sees takes the larger part.
    const int left = width * 56 / 100;
    const int top = height / 2;
    return {{View::laryngoscope, {name_of(View::laryngoscope), 0, 0, left, height}},
            {View::overview, {name_of(View::overview), left, 0, width - left, top}},
            {View::section, {name_of(View::section), left, top, width - left, height - top}}};
}

Compositor::Compositor(int width, int height, int samples)
    : samples_(samples), target_(width, height, samples) {}

void Compositor::resize(int width, int height) {
    if (width != target_.width() || height != target_.height()) {
        target_ = render::RenderTarget(width, height, samples_);
    }
}

void Compositor::draw(Selection selection, const view::SceneView& scene, const hud::Readout& readout,
                      const render::Orbit& orbit, bool measured) {
    const auto views = layout(selection, target_.width(), target_.height());
    std::vector<hud::Tile> tiles;
    target_.bind_scene();
    renderer_.sync(scene);
    for (const PlacedView& placed : views) {
        const auto begin = std::chrono::steady_clock::now();
        const hud::Tile& tile = placed.tile;
        // OpenGL counts rows from below.
        renderer_.draw(placed.view, scene,
                       {tile.x, target_.height() - tile.y - tile.height, tile.width, tile.height}, orbit);
        tiles.push_back(tile);
        if (measured) {
            glFinish();
            DrawTime& time = times_[static_cast<std::size_t>(placed.view)];
            time.sum_ms +=
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
            ++time.frames;
        }
    }
    target_.resolve();
    hud_.draw(readout, tiles, target_.width(), target_.height());
}

int affordable_samples() {
    const std::string driver = render::driver_name();
    const bool software =
        driver.find("llvmpipe") != std::string::npos || driver.find("softpipe") != std::string::npos;
    return software ? 1 : 4;
}

}  // namespace eti::client
