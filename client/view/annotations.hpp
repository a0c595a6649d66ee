// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/codec/annotation.hpp"

namespace eti::view {

class SceneView;

/// By slot: the annotations shown now.
using Annotations = std::map<std::uint32_t, bus::Annotation>;

/// Current position of a place [m], as drawn: on tissue including its displacement by the blade, on the
/// blade at its pose. nullopt if the scene has no such place. As of the last update().
[[nodiscard]] std::optional<Vec3f> current_position(const SceneView& scene, const std::string& object,
                                                    const SurfacePlace& place);

}  // namespace eti::view
