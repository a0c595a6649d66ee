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

/// A note, pointer or drawing of an instructor or observer.
struct Annotation {
    std::uint64_t time_ns = 0;  ///< simulation time at which the server accepted it
    msg::AnnotationKind kind = msg::ANNOTATION_NOTE;
    std::string sender;
    std::string text;
    std::string object;  ///< carries the places
    std::vector<SurfacePlace> places;
};

/// By slot: the annotations shown now.
using Annotations = std::map<std::uint32_t, Annotation>;

/// Decodes a message; nullopt if it is invalid, with the reason in `why`.
[[nodiscard]] std::optional<Annotation> decode(const msg::ShownAnnotation& message, std::string& why);

/// Current position of a place [m], as drawn: on tissue including its displacement by the blade, on the
/// blade at its pose. nullopt if the scene has no such place. As of the last update().
[[nodiscard]] std::optional<Vec3f> current_position(const SceneView& scene, const std::string& object,
                                                    const SurfacePlace& place);

/// Object name of the blade.
inline constexpr const char* laryngoscope_object = "laryngoscope";

}  // namespace eti::view
