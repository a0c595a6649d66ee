// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A foam bubble as a point sprite on the liquid's surface, which lies above the particles. Defines:
// ROOM_SHADOW, LAMP_SHADOW.
#include "scene/shadow_places.glsl"
layout(location = 0) in vec4 bubble;    // relative to `origin` [m], radius [m]
uniform vec3 origin;
uniform mat4 view;
uniform mat4 projection;
uniform vec4 clip_plane;
uniform float lift;         // [m], of the surface above the particles
uniform float height;       // of the picture [pixels]
out vec3 world;
flat out vec3 centre;
flat out vec2 size;         // radius [m], coverage of the point
void main() {
    world = origin + bubble.xyz;
    place_in_shadow_maps(world);
    vec4 p = view * vec4(world, 1.0);
    p.z += lift;
    centre = p.xyz;
    gl_Position = projection * p;
    float across = height * projection[1][1] * bubble.w / gl_Position.w;
    gl_PointSize = max(across, 1.5);
    size = vec2(bubble.w, min(across * across / 2.25, 1.0));
    if (dot(clip_plane, vec4(world, 1.0)) < bubble.w) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
