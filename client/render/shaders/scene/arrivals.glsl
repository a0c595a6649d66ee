// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Light that arrives, including shadows. Included by `lighting`. Defines: ROOM_SHADOW, LAMP_SHADOW.
float reaching(int i) {
#ifdef ROOM_SHADOW
    if (i == 0) {
        return unshadowed(room_depth, room_at);
    }
#endif
#ifdef LAMP_SHADOW
    if (i == 1) {
        return unshadowed(lamp_depth, lamp_at);
    }
#endif
    return 1.0;
}
Arriving arriving(int i) {
    Arriving light = unhindered(i, world);
    light.colour *= reaching(i);
    return light;
}
// As arriving(), where only the fraction `open` of the room's light enters; its shadow map already says so.
Arriving arriving_through_mouth(int i, float open) {
    Arriving light = arriving(i);
#ifndef ROOM_SHADOW
    light.colour *= i == 0 ? open : 1.0;
#endif
    return light;
}
