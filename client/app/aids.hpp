// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <vector>

#include "client/hud/hud.hpp"
#include "client/render/views/view_table.hpp"
#include "client/view/scene_view.hpp"
#include "client/view/sight/line_of_sight.hpp"

namespace eti::client {

/// Returns the marks of the session's aids for a view that fills `tile`, seen through one of its cameras.
/// They are the upper gum in the colour of its contact force while it is pressed, the line of sight to the
/// glottis with its first obstacle, and the airway axes. `look`: the line of sight if the session requests
/// it; the same for every view of a picture.
[[nodiscard]] std::vector<hud::Mark> aid_marks(const render::View& view, const render::Camera& camera,
                                               const view::SceneView& scene, const render::Vantage& from,
                                               const std::optional<view::LineOfSight>& look,
                                               const hud::Tile& tile);

/// Returns the line of sight to the glottis if the session requests it and one of these views shows it.
/// Tests every surface, once for all views.
[[nodiscard]] std::optional<view::LineOfSight> find_line_of_sight(
    const std::vector<const render::View*>& views, const view::SceneView& scene, const render::Vantage& from);

/// Projects a line between two points [m], patient frame, through a camera that fills `tile`; nullopt if
/// the whole line lies behind the camera.
[[nodiscard]] std::optional<hud::Mark> project_line(const Vec3f& from, const Vec3f& to,
                                                    const render::Camera& camera, const hud::Tile& tile);

}  // namespace eti::client
