// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace eti {

/// What a particle, a surface triangle or a contact belongs to. Values go over the bus and into
/// files: append, never renumber.
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
    // Seen alone: no particle and no contact is of these.
    vocal_cord,  ///< the true cords' white
    lip,         ///< vermilion
    cloth,       ///< what wraps the newborn's trunk
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

/// How soft tissue is computed.
enum class TissueMethod : std::uint8_t {
    clusters,    ///< shape matching with compliance throughout
    tetrahedra,  ///< neo-Hookean tetrahedra in the tongue, which bears the blade; else clusters
    implicit,    ///< the same, solved to the end in each step instead of once in each substep
};
inline constexpr std::array<std::string_view, 3> tissue_method_names = {"clusters", "tetrahedra", "implicit"};

[[nodiscard]] constexpr std::string_view name_of(TissueMethod model) {
    return tissue_method_names[static_cast<std::size_t>(model)];
}

}  // namespace eti
