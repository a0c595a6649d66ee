// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/bus/codec/scene_object.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"

namespace eti::render {

/// A vertex colour: sRGB; the fourth byte is the wetness (255: mucosa under saliva).
using VertexColour = std::array<std::uint8_t, 4>;

/// sRGB colour, 0-1, of living tissue under white light; `soft` gives that of mucosa.
[[nodiscard]] Vec3f tissue_colour(Tissue tissue);

/// sRGB colour, 0-1, of the section face of a surface of this tissue.
[[nodiscard]] Vec3f cut_colour(Tissue tissue);

/// Each 0-255: sky visibility, share of mucosa, tissue label; above 127, density of hair, below, how acral.
using VertexRelief = std::array<std::uint8_t, 4>;

/// Label of a tissue in pictures used for measurement.
[[nodiscard]] constexpr std::uint8_t tissue_label(Tissue tissue) {
    return static_cast<std::uint8_t>(20 * (static_cast<int>(tissue) + 1) % 256);
}

/// Appearance of a surface's vertices.
struct SurfaceAppearance {
    std::vector<VertexColour> colours;
    std::vector<VertexRelief> relief;
};

/// Computes vertex colours: tissues blended across their borders, skin distinguished from mucosa by sky
/// visibility, pearly vocal cords, slight mottling. Baked once per scene, because noise in the fragment
/// shader doubles the cost of a picture on a software rasteriser.
[[nodiscard]] SurfaceAppearance surface_appearance(const bus::RestSurface& surface, const Landmarks& rest);

}  // namespace eti::render
