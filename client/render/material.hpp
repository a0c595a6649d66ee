// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/view/scene_object.hpp"
#include "common/model/landmark.hpp"
#include "common/model/tissue.hpp"

namespace eti::render {

/// A vertex's colour: sRGB, and in the fourth byte how wet it is (255: mucosa under saliva).
using VertexColour = std::array<std::uint8_t, 4>;

/// sRGB colour, 0-1, of living tissue under white light; `soft` gives that of mucosa.
[[nodiscard]] Vec3f tissue_colour(Tissue tissue);

/// sRGB colour, 0-1, of a cut through a surface whose tissue is `tissue`.
[[nodiscard]] Vec3f cut_colour(Tissue tissue);

/// Each part 0-255: the share of the sky that a vertex sees, the share of mucosa, and its tissue's label.
using VertexRelief = std::array<std::uint8_t, 4>;

/// Of a tissue in pictures for measuring.
[[nodiscard]] constexpr std::uint8_t tissue_label(Tissue tissue) {
    return static_cast<std::uint8_t>(20 * (static_cast<int>(tissue) + 1) % 256);
}

/// Of a surface's vertices.
struct SurfaceLook {
    std::vector<VertexColour> colours;
    std::vector<VertexRelief> relief;
};

/// Colours of a surface's vertices: tissues blended over their borders, skin told from mucosa by
/// what of the sky it sees, the vocal cords pearly, all slightly mottled. Baked once a scene,
/// because noise in the fragment shader doubles the cost of a picture on a software rasteriser.
[[nodiscard]] SurfaceLook surface_look(const view::RestSurface& surface, const Landmarks& rest);

}  // namespace eti::render
