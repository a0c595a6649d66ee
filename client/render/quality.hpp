// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

namespace eti::render {

/// One rung of the ladder from what a software rasteriser can bear to what a graphics card can do.
struct Quality {
    std::string_view name;
    std::string_view help;
    int samples;          ///< a pixel; more cost memory, and in software time by half
    int shadow_size;      ///< texels along a shadow map's side
    bool coarse_shadows;  ///< thrown by surfaces of fewer triangles
    int shadow_taps;      ///< looks into a shadow map along each side of a soft edge
    int lens_taps;        ///< the same for a lens in the mouth, before which a texel is many pixels wide
    bool
        lit_at_vertices;  ///< tissue, where no lens is close to it: its triangles are a few pixels wide there
    bool refraction;      ///< the tube bends what lies behind it; without, it only covers it in part
    bool fine_outlines;   ///< long edges about an outline are divided and bent, in each view
    bool fine;            ///< pores, vessels and the coat's own relief, computed for each pixel
};

/// Lowest first.
[[nodiscard]] std::span<const Quality> qualities();

/// The rung of a name, or nullptr.
[[nodiscard]] const Quality* quality_named(std::string_view name);

/// What the driver of the current context can afford: the lowest in software, the highest else.
[[nodiscard]] const Quality& affordable_quality();

}  // namespace eti::render
