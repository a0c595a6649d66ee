// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A cotton cloth over a table, level and lit per vertex, outside the reach of the lamp. Defines:
// ROOM_SHADOW.
#include "scene/lights.glsl"
#include "scene/linear_colour.glsl"
#include "scene/shadow_places.glsl"
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 colour;
uniform mat4 view_projection;
uniform vec4 clip_plane;
out vec3 world;
out vec3 in_shade;    // colour in shadow
out vec3 from_room;   // contribution of light 0
void main() {
    const vec3 n = vec3(0.0, -1.0, 0.0);
    world = position;
    vec3 albedo = linear(colour.rgb);
    albedo *= exp(-2.0 * max(length(position.xz) - 0.25, 0.0));
    // A head blocks most of the room's light beneath it.
    albedo *= 0.62 + 0.38 * smoothstep(0.02, 0.10, length(position.xz - vec2(0.0, 0.02)));
    Arriving light = unhindered(0, position);
    in_shade = albedo * ambient(n);
    from_room = albedo * light.colour * max(dot(n, light.direction), 0.0);
    place_in_shadow_maps(position);
    gl_ClipDistance[0] = dot(clip_plane, vec4(position, 1.0));
    gl_Position = view_projection * vec4(position, 1.0);
}
