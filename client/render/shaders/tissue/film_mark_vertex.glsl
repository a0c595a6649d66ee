// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Marks the cell of a liquid particle. Defines: those of film_cells.
#include "tissue/film_cells.glsl"
layout(location = 0) in vec3 position;
void main() {
    ivec3 at = ivec3(floor((position - low) / cell));
    vec2 place = (vec2(pixel_of(at)) + 0.5) / vec2(ROW * SIDE) * 2.0 - 1.0;
    gl_Position = outside(at) ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(place, 0.0, 1.0);
}
