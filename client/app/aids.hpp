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

/// What the session's aids draw over a view that fills `tile`, through one of its cameras: the upper gum in
/// the colour of the force on it, where it is pressed; the look onto the glottis, with the name of what it
/// meets first; the axes of the airway. `look`: where the session asks for it; it is the same in every view
/// of a picture.
[[nodiscard]] std::vector<hud::Mark> aids_of(const render::View& view, const render::Camera& camera,
                                             const view::SceneView& scene, const render::Vantage& from,
                                             const std::optional<view::Look>& look, const hud::Tile& tile);

/// The look onto the glottis, where the session asks for it and one of these views shows it: every surface is
/// tried for it, once for all views.
[[nodiscard]] std::optional<view::Look> look_for(const std::vector<const render::View*>& views,
                                                 const view::SceneView& scene, const render::Vantage& from);

/// A line between two points [m], patient frame, as a camera that fills `tile` sees it; nothing where all of
/// it lies behind the camera.
[[nodiscard]] std::optional<hud::Mark> line_of(const Vec3f& from, const Vec3f& to,
                                               const render::Camera& camera, const hud::Tile& tile);

}  // namespace eti::client
