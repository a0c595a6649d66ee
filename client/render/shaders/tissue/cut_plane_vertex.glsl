// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The section plane itself, extending from `pivot` by `along` and `across`; draw four vertices as a
// strip. Defines: none.
#include "scene/linear_colour.glsl"
uniform mat4 view_projection;
uniform vec3 pivot;
uniform vec3 along;
uniform vec3 across;
uniform vec3 colour;
out vec3 world;
out vec3 colour_at;
void main() {
    vec2 corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
    world = pivot + corner.x * along + corner.y * across;
    colour_at = linear(colour);
    gl_Position = view_projection * vec4(world, 1.0);
}
