// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/surface_place.hpp"
#include "idl/eti_wire.hpp"

namespace eti::view {

class SceneView;

/// What an instructor or observer wrote, points at or drew.
struct Annotation {
    std::uint64_t time_ns = 0;  ///< simulation time at which the server took it
    msg::AnnotationKind kind = msg::ANNOTATION_NOTE;
    std::string sender;
    std::string text;
    std::string object;  ///< on which the places lie
    std::vector<SurfacePlace> places;
};

/// By slot: what of a session is shown now.
using Annotations = std::map<std::uint32_t, Annotation>;

/// What a message holds; nothing, and `why`, when it cannot be right.
[[nodiscard]] std::optional<Annotation> decode(const msg::ShownAnnotation& message, std::string& why);

/// Where a place is now [m], as drawn: of tissue where it gives way to the blade, of the blade as it is held.
/// Nothing where the scene has no such place. As of the last update().
[[nodiscard]] std::optional<Vec3f> where_now(const SceneView& scene, const std::string& object,
                                             const SurfacePlace& place);

/// The object that stands for the blade.
inline constexpr const char* laryngoscope_object = "laryngoscope";

}  // namespace eti::view
