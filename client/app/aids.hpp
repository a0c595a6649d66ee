// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "client/hud/hud.hpp"
#include "client/render/view_table.hpp"
#include "client/view/line_of_sight.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// What the session's aids draw over a view that fills `tile`: the upper gum in the colour of the force on
/// it, where it is pressed; the look onto the glottis, with the name of what it meets first; the axes of the
/// airway. `look`: where the session asks for it; it is the same in every view of a picture.
[[nodiscard]] std::vector<hud::Mark> aids_of(const render::View& view, const view::SceneView& scene,
                                             const render::Vantage& from,
                                             const std::optional<view::Look>& look, const hud::Tile& tile);

/// Whether a view shows where the look onto the glottis ends.
[[nodiscard]] bool shows_look(const render::View& view);

}  // namespace eti::client
