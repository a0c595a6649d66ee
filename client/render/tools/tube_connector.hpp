// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/view/tube_sweep.hpp"

namespace eti::render {

/// The 15 mm connector of a tube: a hollow cone (ISO 5356-1: 15 mm, tapering by 1 in 40), a flange with two
/// lugs for the fingers, and a barbed spigot within the tube's end.
struct TubeConnector {
    std::vector<view::TubeVertex> vertices;  ///< frame of TubeSweep::connector_pose()
    std::vector<Triangle> triangles;         ///< closed; vertices are duplicated along edges
};

[[nodiscard]] TubeConnector make_tube_connector(const Tube& tube);

}  // namespace eti::render
