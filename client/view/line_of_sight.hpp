// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string_view>

#include "client/view/scene_view.hpp"

namespace eti::view {

/// A straight look [m], patient frame.
struct Sight {
    Vec3f from = Vec3f::Zero();  ///< the examiner's eye
    Vec3f to = Vec3f::Zero();    ///< the glottis
};

/// What a look meets first.
struct Obstacle {
    Vec3f where = Vec3f::Zero();  ///< [m]
    std::string_view name;        ///< of the tissue, or "blade"
};

/// From where an examiner best looks onto the glottis, as landmarks now lie.
[[nodiscard]] Sight sight_of(const Landmarks& now);

/// What lies before the glottis, as of the last update(); nothing if it is in sight. Lips are held aside, as
/// where the view is measured: what lies before the upper gum does not count.
[[nodiscard]] std::optional<Obstacle> obstacle(const SceneView& scene, const Sight& sight);

}  // namespace eti::view
