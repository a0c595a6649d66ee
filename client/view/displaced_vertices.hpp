// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/view/scene_view.hpp"
#include "client/view/skinned_surface.hpp"

namespace eti::view {

/// A surface's vertices as drawn: displaced by the laryngoscope at its current pose.
[[nodiscard]] std::vector<LitVertex> displaced_vertices(const SceneView& scene,
                                                        const SkinnedSurface& surface);

}  // namespace eti::view
