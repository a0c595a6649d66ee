// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string_view>

#include "client/view/scene_view.hpp"
#include "client/view/sight/trainee_eye.hpp"

namespace eti::view {

/// A straight line of sight [m], patient frame.
struct SightLine {
    Vec3f from = Vec3f::Zero();  ///< an eye
    Vec3f to = Vec3f::Zero();    ///< the glottis
};

/// The first obstacle on a line of sight.
struct Obstacle {
    Vec3f position = Vec3f::Zero();  ///< [m]
    std::string_view name;           ///< of the tissue, "blade" or "tube"
};

/// From the trainee's eye to the glottis, by current landmarks.
[[nodiscard]] SightLine sight_line(const TraineeEye& eye, const Landmarks& now);

/// The first obstacle on a line of sight, as of the last update(); nullopt if its end is visible. Lips are
/// retracted, as in the trainee's picture.
[[nodiscard]] std::optional<Obstacle> find_obstacle(const SceneView& scene, const SightLine& sight);

/// A line of sight to the glottis and its first obstacle.
struct LineOfSight {
    SightLine sight;
    std::optional<Obstacle> obstacle;
};
[[nodiscard]] LineOfSight trace_line_of_sight(const SceneView& scene, const TraineeEye& eye);

}  // namespace eti::view
