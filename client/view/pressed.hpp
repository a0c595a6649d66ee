// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/view/scene_view.hpp"
#include "client/view/skinned_surface.hpp"

namespace eti::view {

/// A surface's vertices as they are drawn: given way to the laryngoscope where it is held.
[[nodiscard]] std::vector<LitVertex> pressed(const SceneView& scene, const SkinnedSurface& surface);

}  // namespace eti::view
