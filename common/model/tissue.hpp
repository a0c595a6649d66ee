// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace eti {

/// Material of a particle, a surface triangle or a contact. Values are sent on the bus and stored in files:
/// append, never renumber.
enum class Tissue : std::uint8_t {
    soft,  ///< skin, muscle, mucosa of cheeks, pharynx and neck
    tongue,
    epiglottis,
    larynx,  ///< arytenoids, vocal cords, cricoid region
    trachea,
    oesophagus,
    upper_gum,
    lower_gum,
    palate,
    skull,
    mandible,
    spine,
    hyoid,
    // Visual only: no particle or contact has these.
    vocal_cord,  ///< the true cords' white
    lip,         ///< vermilion
    cloth,       ///< the wrap around the newborn's trunk
};
inline constexpr std::size_t tissue_count = 16;

inline constexpr std::array<std::string_view, tissue_count> tissue_names = {
    "soft",   "tongue", "epiglottis", "larynx", "trachea", "oesophagus", "upper gum", "lower gum",
    "palate", "skull",  "mandible",   "spine",  "hyoid",   "vocal cord", "lip",       "cloth"};

[[nodiscard]] constexpr std::string_view name_of(Tissue tissue) {
    return tissue_names[static_cast<std::size_t>(tissue)];
}

[[nodiscard]] constexpr bool is_bone(Tissue tissue) {
    return tissue == Tissue::skull || tissue == Tissue::mandible || tissue == Tissue::spine ||
           tissue == Tissue::hyoid;
}

/// Soft-tissue solver.
enum class TissueMethod : std::uint8_t {
    clusters,  ///< shape matching with compliance throughout
    implicit,  ///< tongue and epiglottis, which carry the blade's load, as one mesh of nearly incompressible
               ///< 8-node hexahedra in an implicit step; clusters elsewhere
};
inline constexpr std::array<std::string_view, 2> tissue_method_names = {"clusters", "implicit"};

[[nodiscard]] constexpr std::string_view name_of(TissueMethod method) {
    return tissue_method_names[static_cast<std::size_t>(method)];
}

}  // namespace eti
