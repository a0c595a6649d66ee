// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string_view>

#include "client/view/scene_view.hpp"
#include "client/view/trainee_eye.hpp"

namespace eti::view {

/// A straight look [m], patient frame.
struct Sight {
    Vec3f from = Vec3f::Zero();  ///< an eye
    Vec3f to = Vec3f::Zero();    ///< the glottis
};

/// What a look meets first.
struct Obstacle {
    Vec3f where = Vec3f::Zero();  ///< [m]
    std::string_view name;        ///< of the tissue, "blade" or "tube"
};

/// From the trainee's eye onto the glottis, as landmarks now lie.
[[nodiscard]] Sight sight_of(const TraineeEye& eye, const Landmarks& now);

/// What lies before the end of a look, as of the last update(); nothing if that is in sight. Lips are held
/// aside, as in the trainee's picture.
[[nodiscard]] std::optional<Obstacle> obstacle(const SceneView& scene, const Sight& sight);

/// A look onto the glottis and what lies before it.
struct Look {
    Sight sight;
    std::optional<Obstacle> met;
};
[[nodiscard]] Look look_of(const SceneView& scene, const TraineeEye& eye);

}  // namespace eti::view
