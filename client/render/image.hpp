// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace eti::render {

/// An sRGB picture, top row first, four bytes (red, green, blue, opacity) per pixel.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;

    [[nodiscard]] const std::uint8_t* pixel(int x, int y) const {
        return rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x));
    }
};

/// Writes an opaque PNG. Throws std::runtime_error naming the file and the remedy.
void write_png(const Image& image, const std::filesystem::path& file);

/// Reads a PNG written by write_png(). Throws std::runtime_error naming the file if it is missing or
/// invalid.
[[nodiscard]] Image read_png(const std::filesystem::path& file);

}  // namespace eti::render
