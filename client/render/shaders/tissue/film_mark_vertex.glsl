// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Marks the cell of a liquid particle. Defines: those of film_cells.
#include "tissue/film_cells.glsl"
#include "liquid/ellipsoid.glsl"
void main() {
    ivec3 at = ivec3(floor((ellipsoid_centre() - low) / cell));
    vec2 pixel = (vec2(pixel_of(at)) + 0.5) / vec2(ROW * SIDE) * 2.0 - 1.0;
    gl_Position = outside(at) ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(pixel, 0.0, 1.0);
}
