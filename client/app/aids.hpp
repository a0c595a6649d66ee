// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/hud/hud.hpp"
#include "client/render/view_table.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// What the session's aids draw over a view that fills `tile`: the upper gum in the colour of the force on
/// it, where it is pressed; the look onto the glottis, with the name of what it meets first; the axes of the
/// airway.
[[nodiscard]] std::vector<hud::Mark> aids_of(const render::View& view, const view::SceneView& scene,
                                             const render::Vantage& from, const hud::Tile& tile);

}  // namespace eti::client
