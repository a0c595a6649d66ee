// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/model/surface.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// Object name of the blade.
inline constexpr const char* laryngoscope_object = "laryngoscope";

/// A skinned surface of the patient in the rest posture, as received.
struct RestSurface : Surface {
    std::uint16_t highest_frame = 0;  ///< largest frame index in `skin`
};

/// Rest centres [m] of the frames that DeformationState moves, a surface of the patient, or the
/// laryngoscope's mesh in its own frame.
using SceneObject = std::variant<std::vector<Vec3f>, RestSurface, TriangleMesh>;

/// Messages without header and object count.
[[nodiscard]] msg::SceneDescription encode_frames(std::span<const Vec3f> rest_centres);
[[nodiscard]] msg::SceneDescription encode_surface(const Surface& surface);
[[nodiscard]] msg::SceneDescription encode_laryngoscope(const TriangleMesh& mesh);

/// Validates a message before anything is stored: matching sizes, indices in range, valid points. Returns
/// nullopt if rejected, with the reason in `why`.
[[nodiscard]] std::optional<SceneObject> decode_scene_object(const msg::SceneDescription& message,
                                                             std::string& why);

}  // namespace eti::bus
