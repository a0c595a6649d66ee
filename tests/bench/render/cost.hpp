// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/render/quality.hpp"
#include "client/view/scene_view.hpp"

namespace eti::bench {

/// What a picture of one view costs.
struct Cost {
    std::string view;
    int width = 0, height = 0;
    double sync_ms = 0.0;  ///< bringing the graphics card up to date; median
    double draw_ms = 0.0;  ///< drawing, until the driver is done; median
    double cpu_ms = 0.0;   ///< processor time of all threads for both, a software driver's among them; median
    double slowest_ms = 0.0;  ///< both together, of the slowest picture
    double kilobytes = 0.0;   ///< sent to the graphics card for a picture; mean
};

/// Draws each view `pictures` times at a size, of two states by turns, so that all has moved that ever moves.
/// The context must be current.
[[nodiscard]] std::vector<Cost> costs(const view::SceneView& a, const view::SceneView& b, int width,
                                      int height, int pictures, const render::Quality& quality);

}  // namespace eti::bench
