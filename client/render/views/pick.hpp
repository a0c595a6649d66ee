// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "client/render/views/view_table.hpp"
#include "client/view/scene_view.hpp"
#include "common/mesh/surface_place.hpp"

namespace eti::render {

/// What a view shows at a point of its picture.
struct PickHit {
    Vec3f position = Vec3f::Zero();  ///< [m], patient frame; unretracted position for retracted lips
    std::string_view name;           ///< of the tissue, "blade" or "tube"
    std::string object{};            ///< scene object; empty where marking is impossible: on the tube
    SurfacePlace place{};
};

/// `x`, `y`: -1 to 1, from the picture's left and bottom. nullopt for the background. Uses the state of the
/// last update(); tests every triangle, 1-2 ms.
[[nodiscard]] std::optional<PickHit> pick(const View& view, const view::SceneView& scene, const Vantage& from,
                                          float aspect, float x, float y);

}  // namespace eti::render
