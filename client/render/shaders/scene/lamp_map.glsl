// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Maps a point to the lamp's shadow map: a paraboloid map shows the half space in front of the lamp
// as a disc of nearly uniform resolution (Brabec et al. 2002). A planar map of this lamp's cone
// would spend nine tenths of its texels on rays more than 64 degrees from the axis. Defines:
// LAMP_SHADOW or FROM_LAMP, else empty.
#if defined(LAMP_SHADOW) || defined(FROM_LAMP)
uniform mat4 to_lamp;        // z axis along the light
uniform vec2 lamp_depths;    // depth range [m]
// Disc coordinates from -1 to 1; depth from 0 to 1; distance [m] in front of the lamp.
vec4 in_lamp_map(vec3 p) {
    vec3 q = (to_lamp * vec4(p, 1.0)).xyz;
    float away = length(q);
    return vec4(q.xy / max(away + q.z, 1e-6), (away - lamp_depths.x) / (lamp_depths.y - lamp_depths.x), q.z);
}
vec3 lamp_texel(vec3 p) {
    vec4 at = in_lamp_map(p);
    return vec3(0.5 + 0.5 * at.xy, at.z);
}
#endif
