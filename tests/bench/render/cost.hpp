// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/render/quality.hpp"
#include "client/view/scene_view.hpp"

namespace eti::bench {

/// Cost of a picture of one view.
struct Cost {
    std::string view;
    int width = 0, height = 0;
    double sync_ms = 0.0;  ///< upload to the graphics card; median
    double draw_ms = 0.0;  ///< drawing, until the driver is done; median
    double cpu_ms = 0.0;   ///< processor time of all threads for both, including a software driver's; median
    double slowest_ms = 0.0;  ///< both together, of the slowest picture
    double kilobytes = 0.0;   ///< uploaded to the graphics card per picture; mean
};

/// Draws each view `pictures` times at a size, alternating between two states, so that everything that can
/// move has moved. The context must be current.
[[nodiscard]] std::vector<Cost> costs(const view::SceneView& a, const view::SceneView& b, int width,
                                      int height, int pictures, const render::Quality& quality);

}  // namespace eti::bench
