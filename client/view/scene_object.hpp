// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"
#include "idl/eti.h"

namespace eti::view {

/// Rest centres [m] of the frames that DeformationState moves.
struct FrameModel {
    std::vector<Vec3f> rest_centre;
};

/// A skinned surface of the patient in the rest posture.
struct SurfaceModel {
    std::string name;
    Tissue tissue = Tissue::soft;
    TriangleMesh mesh;
    std::vector<Tissue> triangle_tissue;  ///< one per triangle
    std::vector<SkinWeights> skin;        ///< one per vertex
    std::uint16_t highest_frame = 0;      ///< largest frame index in `skin`
};

/// A rigid surface in the laryngoscope's frame.
struct ToolModel {
    TriangleMesh mesh;
    float blade_length = 0.0f;  ///< [m], origin to the farthest vertex along the blade (+z)
};

/// The tube's measures [m]; its course comes with DeformationState.
struct TubeModel {
    float outer_radius = 2.1e-3f;
    float inner_radius = 1.5e-3f;
    float length = 0.16f;
    float grip_from_tip = 0.10f;
    float curve_radius = 0.14f;
};

/// Landmarks in the rest posture [m].
struct LandmarkModel {
    Landmarks rest{};
};

using SceneObject = std::variant<FrameModel, SurfaceModel, ToolModel, TubeModel, LandmarkModel>;

/// Coordinates beyond this [m] from the patient's gum are taken for damage on the way, not for anatomy.
inline constexpr float farthest_coordinate = 10.0f;

/// Checks everything a message claims before anything is kept: sizes that match, indices in range,
/// finite coordinates. Nothing on refusal; `why` then says what was wrong.
[[nodiscard]] std::optional<SceneObject> decode(const msg::SceneDescription& message, std::string& why);

/// Finite and within `farthest_coordinate`.
[[nodiscard]] bool plausible(const Vec3f& point);

}  // namespace eti::view
