// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Tissue lit per vertex by tissue_lit_vertex: adds the shadows per pixel. Defines: ROOM_SHADOW,
// LAMP_SHADOW, TAPS.
#include "scene/shadows.glsl"
in vec3 unshaded;
#ifdef ROOM_SHADOW
in vec3 from_room;
#endif
#ifdef LAMP_SHADOW
in vec3 from_lamp;
#endif
void main() {
    vec3 sum = unshaded;
#ifdef ROOM_SHADOW
    sum += unshadowed(room_depth, room_at) * from_room;
#endif
#ifdef LAMP_SHADOW
    sum += unshadowed(lamp_depth, lamp_at) * from_lamp;
#endif
    pixel = vec4(min(sum, brightest), 1.0);
}
