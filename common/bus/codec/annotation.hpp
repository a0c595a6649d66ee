// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/mesh/surface_place.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// A note, pointer or drawing of an instructor or observer.
struct Annotation {
    std::uint64_t time_ns = 0;  ///< simulation time at which the server accepted it
    msg::AnnotationKind kind = msg::ANNOTATION_NOTE;
    std::string sender;
    std::string text;
    std::string object;  ///< carries the places
    std::vector<SurfacePlace> places;
};

/// The message without header. Places beyond the message's bound are left out.
[[nodiscard]] msg::Annotation encode_annotation(const Annotation& annotation);

/// Decodes a message; nullopt if it is invalid, with the reason in `why`.
[[nodiscard]] std::optional<Annotation> decode_annotation(const msg::ShownAnnotation& message,
                                                          std::string& why);

[[nodiscard]] inline SurfacePlace from_msg(const msg::SurfacePlace& place) {
    return {place.triangle(), place.u(), place.v(), place.height()};
}

}  // namespace eti::bus
