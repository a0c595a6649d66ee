// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Cells of a cube of SIDE^3, its layers side by side in one picture, ROW to a row.
inline constexpr std::string_view film_cells = R"(
uniform vec3 low;       // corner of the cube [m]
uniform float cell;     // [m]
ivec2 pixel_of(ivec3 at) { return ivec2(at.z % ROW, at.z / ROW) * SIDE + at.xy; }
bool outside(ivec3 at) { return any(lessThan(at, ivec3(0))) || any(greaterThanEqual(at, ivec3(SIDE))); }
)";

/// Marks a particle's cell: goes after film_cells.
inline constexpr std::string_view film_mark_vertex = R"(
layout(location = 0) in vec3 position;
void main() {
    ivec3 at = ivec3(floor((position - low) / cell));
    vec2 place = (vec2(pixel_of(at)) + 0.5) / vec2(ROW * SIDE) * 2.0 - 1.0;
    gl_Position = outside(at) ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(place, 0.0, 1.0);
}
)";

inline constexpr std::string_view film_mark_fragment = R"(
out vec4 marked;
void main() { marked = vec4(1.0); }
)";

/// A vertex's film dries, and is whole again where liquid touches: goes after film_cells.
inline constexpr std::string_view film_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in float film;
uniform sampler2D marks;
uniform vec3 reach_low, reach_high;     // the liquid's box and a cell [m]
uniform float stays;    // share that is not dry since the last time
out float wetted;
void main() {
    vec3 q = (position - low) / cell - 0.5;
    ivec3 base = ivec3(floor(q));
    vec3 w = q - vec3(base);
    float touched = 0.0;
    bool near = all(greaterThan(position, reach_low)) && all(lessThan(position, reach_high));
    int corners = near ? 8 : 0;     // a loop that ends at once is what software skips
    for (int k = 0; k < corners; ++k) {
        ivec3 corner = ivec3(k & 1, k >> 1 & 1, k >> 2);
        ivec3 at = base + corner;
        vec3 share = mix(1.0 - w, w, vec3(corner));
        if (!outside(at)) {
            touched += share.x * share.y * share.z * texelFetch(marks, pixel_of(at), 0).r;
        }
    }
    // Where one cell alone is marked, this share's border is round: a lower one's has corners.
    wetted = max(film * stays, smoothstep(0.08, 0.135, touched));
}
)";

}  // namespace eti::render::source
