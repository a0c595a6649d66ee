// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>

#include "client/render/image.hpp"
#include "tests/bench/render/attempt.hpp"

namespace eti::bench {

/// The resampled image; each pixel is the mean of the pixels it covers.
[[nodiscard]] inline render::Image downscaled(const render::Image& picture, int width, int height) {
    render::Image small{.width = width, .height = height, .rgba = {}};
    small.rgba.reserve(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const int x0 = x * picture.width / width, y0 = y * picture.height / height;
            const int x1 = std::max((x + 1) * picture.width / width, x0 + 1);
            const int y1 = std::max((y + 1) * picture.height / height, y0 + 1);
            std::array<int, 4> sum{};
            for (int v = y0; v < y1; ++v) {
                for (int u = x0; u < x1; ++u) {
                    for (std::size_t k = 0; k < 4; ++k) {
                        sum[k] += picture.pixel(u, v)[k];
                    }
                }
            }
            for (const int of : sum) {
                small.rgba.push_back(static_cast<std::uint8_t>(of / ((x1 - x0) * (y1 - y0))));
            }
        }
    }
    return small;
}

/// Two pictures of one size beside each other.
[[nodiscard]] inline render::Image side_by_side(const render::Image& left, const render::Image& right) {
    render::Image both{.width = left.width + right.width, .height = right.height, .rgba = {}};
    for (int y = 0; y < both.height; ++y) {
        for (const render::Image* const half : {&left, &right}) {
            both.rgba.insert(both.rgba.end(), half->pixel(0, y), half->pixel(0, y) + 4 * half->width);
        }
    }
    return both;
}

/// A contact sheet: moments from left to right, views from top to bottom.
class ContactSheet {
  public:
    ContactSheet(std::size_t views, int width, int height)
        : tile_width_(320), tile_height_(320 * height / width) {
        sheet_.width = tile_width_ * static_cast<int>(moment_names.size());
        sheet_.height = tile_height_ * static_cast<int>(views);
        sheet_.rgba.assign(
            4 * static_cast<std::size_t>(sheet_.width) * static_cast<std::size_t>(sheet_.height), 40);
    }

    void put(std::size_t moment, std::size_t view, const render::Image& picture) {
        const render::Image tile = downscaled(picture, tile_width_, tile_height_);
        for (int y = 0; y < tile_height_; ++y) {
            const std::size_t to =
                (static_cast<std::size_t>(y) + view * static_cast<std::size_t>(tile_height_)) *
                    static_cast<std::size_t>(sheet_.width) +
                moment * static_cast<std::size_t>(tile_width_);
            std::copy_n(tile.pixel(0, y), 4 * tile_width_,
                        sheet_.rgba.begin() + static_cast<std::ptrdiff_t>(4 * to));
        }
    }

    void write(const std::filesystem::path& file) const { render::write_png(sheet_, file); }

  private:
    int tile_width_, tile_height_;
    render::Image sheet_;
};

}  // namespace eti::bench
