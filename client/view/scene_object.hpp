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
#include "common/model/tissue.hpp"
#include "idl/eti.h"

namespace eti::view {

/// Rest centres [m] of the frames that DeformationState moves.
struct RestFrames {
    std::vector<Vec3f> rest_centre;
};

/// A skinned surface of the patient in the rest posture.
struct RestSurface {
    std::string name;
    Tissue tissue = Tissue::soft;
    TriangleMesh mesh;
    std::vector<Tissue> triangle_tissue;  ///< one per triangle
    std::vector<SkinWeights> skin;        ///< one per vertex
    std::uint16_t highest_frame = 0;      ///< largest frame index in `skin`
};

/// A rigid surface in the laryngoscope's frame.
struct ToolMesh {
    TriangleMesh mesh;
};

using SceneObject = std::variant<RestFrames, RestSurface, ToolMesh>;

/// Coordinates beyond this [m] from the patient's gum are treated as corrupt.
inline constexpr float max_coordinate = 10.0f;

/// Validates a message before anything is stored: matching sizes, indices in range, finite coordinates.
/// Returns nullopt if rejected, with the reason in `why`.
[[nodiscard]] std::optional<SceneObject> decode(const msg::SceneDescription& message, std::string& why);

/// Finite and within `max_coordinate`.
[[nodiscard]] bool plausible(const Vec3f& point);

}  // namespace eti::view
