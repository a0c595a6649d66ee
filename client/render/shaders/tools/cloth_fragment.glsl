// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The table's cloth. Defines: FINE (with its weave), ROOM_SHADOW, TAPS.
in vec3 world;
#include "scene/lighting.glsl"
in vec3 in_shade;
in vec3 from_room;
void main() {
    vec3 sum = in_shade;
#ifdef ROOM_SHADOW
    sum += unshadowed(room_depth, room_at) * from_room;
#else
    sum += from_room;
#endif
#ifdef FINE
    // At a distance the weave is finer than a pixel.
    float weave = 0.25 * (sin(world.x * 2200.0) + sin(world.z * 2200.0));
    sum *= 0.97 + 0.06 * weave * (1.0 - smoothstep(0.3, 0.7, length(eye - world)));
#endif
    pixel = vec4(min(sum, brightest), 1.0);
}
