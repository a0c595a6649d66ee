// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::render {

/// Pixels from the picture's lower left corner.
struct Viewport {
    int x = 0, y = 0, width = 640, height = 480;

    [[nodiscard]] float aspect() const { return static_cast<float>(width) / static_cast<float>(height); }
};

}  // namespace eti::render
