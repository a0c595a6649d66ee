// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "client/view/scene_view.hpp"
#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/attempt_metrics.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"
#include "tests/support/session_description.hpp"

namespace eti::synthetic {

/// A head with mouth, throat and trachea, tongue, epiglottis, glottic ring, spine, blade and tube, made of
/// ellipsoids and capsules: closed surfaces with known centres, small enough for a unit test.
struct Scene {
    msg::SessionDescription description;
    std::vector<msg::SceneDescription> objects;
    std::vector<Vec3f> rest_centres;  ///< frames: trunk, skull, tongue, epiglottis
    Landmarks landmarks{};
};

[[nodiscard]] Scene make_scene();

/// Meshes of the single objects.
[[nodiscard]] TriangleMesh body_mesh();

/// Every frame at its rest pose, except that the tongue is lifted by `lift` [m]; the tube along mouth,
/// glottis and trachea, `depth` [m] past the glottis.
[[nodiscard]] msg::DeformationState deformation(const Scene& scene, std::uint64_t time_ns, float lift,
                                                float depth);
/// Blade from the mouth to the vallecula.
[[nodiscard]] msg::ProxyState proxy(const Scene& scene, std::uint64_t time_ns);
[[nodiscard]] msg::LiveMetrics metrics(const Scene& scene, std::uint64_t time_ns,
                                       float glottic_opening_percent);
void set(msg::LiveMetrics& message, float LiveMeasures::*measure, float value);
/// Initial values, except those that a manikin cannot measure.
[[nodiscard]] AttemptMetrics manikin_metrics();
/// Every metric is its index in the table, except the tube's speed, which is NaN: it never entered.
[[nodiscard]] msg::AttemptSummary summary(std::uint32_t attempt, bool success, std::uint64_t time_ns);
[[nodiscard]] msg::SessionStatus status(msg::SessionPhase phase);

/// A SceneView to which all of the above was applied.
void fill(view::SceneView& view, const Scene& scene);

}  // namespace eti::synthetic
