// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

#include "client/render/image.hpp"
#include "tests/bench/render/attempt.hpp"

namespace eti::bench {

/// A contact sheet: moments from left to right, views from above.
class Sheet {
  public:
    Sheet(std::size_t views, int width, int height) : tile_width_(320), tile_height_(320 * height / width) {
        sheet_.width = tile_width_ * static_cast<int>(moment_names.size());
        sheet_.height = tile_height_ * static_cast<int>(views);
        sheet_.rgba.assign(
            4 * static_cast<std::size_t>(sheet_.width) * static_cast<std::size_t>(sheet_.height), 40);
    }

    void put(std::size_t moment, std::size_t view, const render::Image& picture) {
        for (int y = 0; y < tile_height_; ++y) {
            for (int x = 0; x < tile_width_; ++x) {
                // The mean over the pixels that one of the tile stands for.
                const int x0 = x * picture.width / tile_width_, x1 = (x + 1) * picture.width / tile_width_;
                const int y0 = y * picture.height / tile_height_,
                          y1 = (y + 1) * picture.height / tile_height_;
                std::array<int, 4> sum{};
                for (int v = y0; v < y1; ++v) {
                    for (int u = x0; u < x1; ++u) {
                        for (std::size_t k = 0; k < 4; ++k) {
                            sum[k] += picture.pixel(u, v)[k];
                        }
                    }
                }
                const int count = std::max((x1 - x0) * (y1 - y0), 1);
                const int px = static_cast<int>(moment) * tile_width_ + x;
                const int py = static_cast<int>(view) * tile_height_ + y;
                for (std::size_t k = 0; k < 4; ++k) {
                    sheet_.rgba[4 * (static_cast<std::size_t>(py) * static_cast<std::size_t>(sheet_.width) +
                                     static_cast<std::size_t>(px)) +
                                k] = static_cast<std::uint8_t>(sum[k] / count);
                }
            }
        }
    }

    void write(const std::filesystem::path& file) const { render::write_png(sheet_, file); }

  private:
    int tile_width_, tile_height_;
    render::Image sheet_;
};

}  // namespace eti::bench
