// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "client/render/view_table.hpp"
#include "client/view/scene_view.hpp"
#include "common/mesh/surface_place.hpp"

namespace eti::render {

/// What is drawn at a point of a view's picture.
struct Picked {
    Vec3f where = Vec3f::Zero();  ///< [m], patient frame; lips as they lie, not as fingers hold them aside
    std::string_view name;        ///< of the tissue, "blade" or "tube"
    std::string object{};         ///< of the scene; empty where nothing can be marked: on the tube
    SurfacePlace place{};
};

/// `x`, `y`: -1 to 1, from the picture's left and from below. Nothing where the background is seen. By the
/// last update(); looks at every triangle, a millisecond or two.
[[nodiscard]] std::optional<Picked> pick(const View& view, const view::SceneView& scene, const Vantage& from,
                                         float aspect, float x, float y);

}  // namespace eti::render
