// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Updates the film of each vertex by transform feedback: it dries, and is full again where liquid
// touches. Defines: those of film_cells.
#include "tissue/film_cells.glsl"
layout(location = 0) in vec3 position;
layout(location = 1) in float film;
uniform sampler2D marks;
uniform vec3 reach_low, reach_high;     // the liquid's box, extended by a cell [m]
uniform float stays;    // fraction left after drying since the last update
out float wetted;
void main() {
    vec3 q = (position - low) / cell - 0.5;
    ivec3 base = ivec3(floor(q));
    vec3 w = q - vec3(base);
    float touched = 0.0;
    bool near = all(greaterThan(position, reach_low)) && all(lessThan(position, reach_high));
    int corners = near ? 8 : 0;     // software rasterisers skip an empty loop
    for (int k = 0; k < corners; ++k) {
        ivec3 corner = ivec3(k & 1, k >> 1 & 1, k >> 2);
        ivec3 at = base + corner;
        vec3 share = mix(1.0 - w, w, vec3(corner));
        if (!outside(at)) {
            touched += share.x * share.y * share.z * texelFetch(marks, pixel_of(at), 0).r;
        }
    }
    // Around a single marked cell this threshold gives a round border; a lower one has corners.
    wetted = max(film * stays, smoothstep(0.08, 0.135, touched));
}
