// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Passes a point's places in the shadow maps on to `shadows`. Draws nothing. Defines: ROOM_SHADOW, LAMP_SHADOW,
// FROM_LAMP (as in lamp_map), LOOKED_UP (empty if the shader itself samples the maps, which then has declared the
// places; else they are outputs).
#include "scene/lamp_map.glsl"
#ifdef ROOM_SHADOW
uniform mat4 room_lookup;
#ifndef LOOKED_UP
out vec3 room_at;
#endif
#endif
#if defined(LAMP_SHADOW) && !defined(LOOKED_UP)
out vec3 lamp_at;
#endif
void place_in_shadow_maps(vec3 p) {
#ifdef ROOM_SHADOW
    room_at = (room_lookup * vec4(p, 1.0)).xyz;
#endif
#ifdef LAMP_SHADOW
    lamp_at = lamp_texel(p);
#endif
}
