// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

namespace eti::render {

/// A quality level, from software rasterisers to powerful GPUs.
struct Quality {
    std::string_view name;
    std::string_view help;
    int samples;           ///< per pixel; more cost memory and, in software, half as much time again
    int shadow_size;       ///< shadow map size [texels]
    bool coarse_shadows;   ///< cast by simplified surfaces
    int shadow_taps;       ///< shadow map samples per side of the filter kernel
    int lens_taps;         ///< the same for a lens in the mouth, where a texel covers many pixels
    bool lit_at_vertices;  ///< per-vertex lighting of tissue away from a lens, where triangles are a few
                           ///< pixels wide
    bool refraction;       ///< the tube refracts the background; otherwise it only blends with it
    bool fine_outlines;    ///< long outline edges are subdivided and curved, per view
    bool environment;      ///< ambient light and reflections by direction, from the room; else two colours
    bool walls;            ///< the room as far as its walls; otherwise the table in a plain surrounding
    bool fine;             ///< pores, vessels and relief of the wet coat, computed per pixel
};

/// Lowest first.
[[nodiscard]] std::span<const Quality> qualities();

/// The level of a name, or nullptr.
[[nodiscard]] const Quality* quality_named(std::string_view name);

/// The level that the current context's driver can afford: the lowest for software, otherwise the highest.
[[nodiscard]] const Quality& affordable_quality();

}  // namespace eti::render
