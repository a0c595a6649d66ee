// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/imaging/bytes.hpp"

namespace eti::imaging {

/// An sRGB picture, top row first, three bytes (red, green, blue) per pixel.
struct Picture {
    int width = 0;
    int height = 0;
    Bytes rgb;
};

/// Encodes a whole PNG file (PNG specification, third edition): 8 bit RGB, not interlaced.
[[nodiscard]] Bytes encode_png(const Picture& picture);

}  // namespace eti::imaging
