// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/room/solid.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::render {

/// Gloss of knurled steel, as the fourth byte of a colour; polished steel has 255.
inline constexpr std::uint8_t knurled_gloss = 110;
inline constexpr VertexColour steel_colour{198, 200, 205, 255};

/// What a laryngoscope has beside the surface that touches the patient, in its own frame: domed cap, knurled
/// grip and collar of the handle, the green ring of a fibre-light system (ISO 7376), hook-on fitting, the
/// light's tube beside the flange, and the beads along flange and tip of a Miller blade (Miller 1941,
/// Anesthesiology 2:317). It is only drawn: no part that tissue can reach protrudes from the contact shape or
/// the blade by more than the following [m].
inline constexpr float laryngoscope_detail_protrusion = 0.3e-3f;
[[nodiscard]] Solid laryngoscope_details(const Laryngoscope& scope);

}  // namespace eti::render
