// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/eye_compositor.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "client/app/aids.hpp"
#include "client/render/views/view_table.hpp"

namespace eti::client {
namespace {

void clear(const render::RenderTarget& target, float opacity) {
    target.bind_picture();
    glClearColor(0.0f, 0.0f, 0.0f, opacity);
    glClear(GL_COLOR_BUFFER_BIT);
}

}  // namespace

EyeCompositor::EyeCompositor(int eye_width, int eye_height, const render::Quality& quality)
    : stereo_(2 * eye_width, eye_height, quality.samples),
      readout_picture_(readout_width, readout_height, 1),
      renderer_(quality) {}

void EyeCompositor::draw_eyes(const view::SceneView& scene, const render::Vantage& from, bool shown,
                              std::span<const LaserRay> rays) {
    const render::View& view = render::headset_view();
    clear(stereo_, 1.0f);
    renderer_.sync(scene, render::Baking::in_background);
    if (!shown || from.headset_eyes.size() != 2) {
        return;
    }
    renderer_.draw(view, scene, stereo_, {0, 0, stereo_.width(), stereo_.height()}, from);
    const std::optional<view::LineOfSight> look = find_line_of_sight({&view}, scene, from);
    const int wide = stereo_.width() / 2;
    std::array<hud::Tile, 2> eyes{hud::Tile{{}, 0, 0, wide, stereo_.height()},
                                  hud::Tile{{}, wide, 0, wide, stereo_.height()}};
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        hud::Tile& eye = eyes[i];
        eye.marks = aid_marks(view, from.headset_eyes[i], scene, from, look, eye);
        for (const LaserRay& ray : rays) {
            if (const auto line = project_line(ray.from, ray.to, from.headset_eyes[i], eye)) {
                eye.marks.push_back(*line);
            }
        }
    }
    stereo_.bind_picture();
    hud_.draw_eyes(eyes, stereo_.width(), stereo_.height());
}

void EyeCompositor::finish() const {
    glFinish();
}

void EyeCompositor::mirror(int width, int height) const {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    const render::Viewport eye{0, 0, stereo_.width() / 2, stereo_.height()};
    const int wide = std::min(width, height * eye.width / eye.height);
    const int high = std::min(height, width * eye.height / eye.width);
    stereo_.copy_to(0, eye, {(width - wide) / 2, (height - high) / 2, wide, high});
}

void EyeCompositor::draw_readout(const hud::Readout& readout) {
    clear(readout_picture_, 0.0f);
    const std::array tiles{hud::Tile{render::headset_view().name, 0, 0, readout_width, readout_height}};
    hud_.draw(readout, tiles, readout_width, readout_height);
}

}  // namespace eti::client
