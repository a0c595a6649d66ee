// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Matter of the room, outside the reach of the lamp: diffuse light per vertex. The colour's fourth component is
// the gloss. Defines: FINE, TERRY (the height apart from the place), ROOM_SHADOW, ENVIRONMENT.
#include "scene/lights.glsl"
#include "scene/linear_colour.glsl"
#include "scene/shadow_places.glsl"
#ifdef TERRY
layout(location = 0) in vec2 place;
layout(location = 7) in float height;
#else
layout(location = 0) in vec3 position;
#endif
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
uniform mat4 model;
uniform mat4 view_projection;
uniform vec4 clip_plane;
out vec3 world;
out vec3 in_shade;    // light scattered in the shadow of light 0
out vec3 from_room;   // contribution of light 0
#ifdef FINE
out vec3 normal_at;
out float gloss;
#endif
void main() {
#ifdef TERRY
    vec3 position = vec3(place.x, height, place.y);
#endif
    vec4 p = model * vec4(position, 1.0);
    vec3 n = mat3(model) * normal;
    world = p.xyz;
    // Polished steel scatters little.
    vec3 albedo = linear(colour.rgb) * (colour.a > 0.99 ? 0.35 : 1.0);
    Arriving light = unhindered(0, world);
    in_shade = albedo * ambient(n);
    from_room = albedo * light.colour * max(dot(n, light.direction), 0.0);
#ifdef FINE
    normal_at = n;
    gloss = colour.a;
#endif
    place_in_shadow_maps(world);
    gl_ClipDistance[0] = dot(clip_plane, p);
    gl_Position = view_projection * p;
}
