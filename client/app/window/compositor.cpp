// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/compositor.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "client/app/aids.hpp"

namespace eti::client {

namespace {

std::vector<PlacedView> rows_of_two(const Views& views, int width, int height) {
    std::vector<PlacedView> out;
    const int count = static_cast<int>(views.size()), rows = (count + 1) / 2;
    for (int i = 0; i < count; ++i) {
        const int row = i / 2, in_row = std::min(2, count - 2 * row);
        const int left = width * (i % 2) / in_row, right = width * (i % 2 + 1) / in_row;
        const int top = height * row / rows, bottom = height * (row + 1) / rows;
        const render::View* const view = views[static_cast<std::size_t>(i)];
        out.push_back({view, {view->name, left, top, right - left, bottom - top}});
    }
    return out;
}

}  // namespace

std::vector<PlacedView> layout(const Views& views, int width, int height, Arrangement arrangement) {
    if (arrangement == Arrangement::even) {
        return rows_of_two(views, width, height);
    }
    std::vector<PlacedView> out;
    const int others = static_cast<int>(views.size()) - 1;
    const bool upright = height > width;
    // Along the longer side.
    const int along = upright ? height : width, across = upright ? width : height;
    const int first = others > 0 ? along * 56 / 100 : along;
    for (int i = 0; i <= others; ++i) {
        const render::View* const view = views[static_cast<std::size_t>(i)];
        const int begin = i == 0 ? 0 : across * (i - 1) / others;
        const int end = i == 0 ? across : across * i / others;
        const int near = i == 0 ? 0 : first, far = i == 0 ? first : along;
        out.push_back({view, upright ? hud::Tile{view->name, begin, near, end - begin, far - near}
                                     : hud::Tile{view->name, near, begin, far - near, end - begin}});
    }
    return out;
}

std::optional<PlacedView> placed_at(const Selection& selection, const view::SceneView& scene, int width,
                                    int height, float x, float y) {
    const auto all = layout(selection.views(scene), width, height, selection.arrangement);
    const auto found = std::ranges::find_if(all, [&](const PlacedView& placed) {
        const hud::Tile& tile = placed.tile;
        return x >= static_cast<float>(tile.x) && x < static_cast<float>(tile.x + tile.width) &&
               y >= static_cast<float>(tile.y) && y < static_cast<float>(tile.y + tile.height);
    });
    return found != all.end() ? std::optional(*found) : std::nullopt;
}

Compositor::Compositor(int width, int height, const render::Quality& quality)
    : quality_(&quality),
      target_(width, height, quality.samples),
      renderer_(std::in_place, quality),
      times_(render::views().size()) {}

void Compositor::set_quality(const render::Quality& quality) {
    if (quality_ != &quality) {
        quality_ = &quality;
        target_ = render::RenderTarget(target_.width(), target_.height(), quality.samples);
        renderer_.emplace(quality);
    }
}

void Compositor::resize(int width, int height) {
    if (width != target_.width() || height != target_.height()) {
        target_ = render::RenderTarget(width, height, quality_->samples);
    }
}

void Compositor::draw(const Views& views, const view::SceneView& scene, const hud::Readout& readout,
                      const render::Vantage& from, bool measured, Arrangement arrangement) {
    std::vector<hud::Tile> tiles;
    target_.bind_picture();
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    const auto start = std::chrono::steady_clock::now();
    renderer_->sync(scene, baking_);
    if (measured) {
        glFinish();
        sync_time_.add(start);
    }
    const std::optional<view::LineOfSight> look = find_line_of_sight(views, scene, from);
    for (const PlacedView& placed : layout(views, target_.width(), target_.height(), arrangement)) {
        const auto begin = std::chrono::steady_clock::now();
        hud::Tile tile = placed.tile;
        tile.magnification = placed.view->loupe ? from.loupe.magnification : 1.0f;
        tile.marks = aid_marks(*placed.view, placed.view->camera(scene, from), scene, from, look, tile);
        // OpenGL counts rows from below.
        renderer_->draw(*placed.view, scene, target_,
                        {tile.x, target_.height() - tile.y - tile.height, tile.width, tile.height}, from);
        tiles.push_back(tile);
        if (measured) {
            glFinish();
            times_[static_cast<std::size_t>(placed.view - render::views().data())].add(begin);
        }
    }
    target_.bind_picture();
    hud_.draw(readout, tiles, target_.width(), target_.height());
}

}  // namespace eti::client
