// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/compositor.hpp"

#include <chrono>
#include <string>

#include "client/app/aids.hpp"
#include "client/render/headless_context.hpp"

namespace eti::client {

std::vector<PlacedView> layout(const Views& views, int width, int height) {
    std::vector<PlacedView> out;
    const int beside = static_cast<int>(views.size()) - 1;
    const int left = beside > 0 ? width * 56 / 100 : width;
    for (int i = 0; i <= beside; ++i) {
        const render::View* const view = views[static_cast<std::size_t>(i)];
        if (i == 0) {
            out.push_back({view, {view->name, 0, 0, left, height}});
        } else {
            const int top = height * (i - 1) / beside, bottom = height * i / beside;
            out.push_back({view, {view->name, left, top, width - left, bottom - top}});
        }
    }
    return out;
}

Compositor::Compositor(int width, int height, int samples)
    : samples_(samples), target_(width, height, samples), times_(render::views().size()) {}

void Compositor::resize(int width, int height) {
    if (width != target_.width() || height != target_.height()) {
        target_ = render::RenderTarget(width, height, samples_);
    }
}

void Compositor::draw(const Views& views, const view::SceneView& scene, const hud::Readout& readout,
                      const render::Vantage& vantage, bool measured) {
    std::vector<hud::Tile> tiles;
    target_.bind_scene();
    renderer_.sync(scene);
    for (const PlacedView& placed : layout(views, target_.width(), target_.height())) {
        const auto begin = std::chrono::steady_clock::now();
        hud::Tile tile = placed.tile;
        if (scene.enhanced()) {
            tile.marks = aids_of(*placed.view, scene, vantage, tile);
        }
        // OpenGL counts rows from below.
        renderer_.draw(*placed.view, scene,
                       {tile.x, target_.height() - tile.y - tile.height, tile.width, tile.height}, vantage);
        tiles.push_back(tile);
        if (measured) {
            glFinish();
            DrawTime& time = times_[static_cast<std::size_t>(placed.view - render::views().data())];
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
