// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A particle's ellipsoid as LiquidSurface packs it. Draws nothing. Defines: none.
layout(location = 0) in vec3 place;     // in the liquid's box, 0-1
layout(location = 1) in vec3 radii;     // of `largest`, ascending
layout(location = 2) in vec3 turn;      // vector part of a quaternion whose scalar part is positive
uniform vec3 box_low, box_size;         // [m]
uniform float largest;                  // [m]
vec3 ellipsoid_centre() { return box_low + place * box_size; }
mat3 ellipsoid_axes(vec3 r) {
    vec4 q = vec4(turn, sqrt(max(1.0 - dot(turn, turn), 0.0)));
    vec3 two = 2.0 * q.xyz;
    return mat3(r.x * vec3(1.0 - two.y * q.y - two.z * q.z, two.x * q.y + two.z * q.w, two.x * q.z - two.y * q.w),
                r.y * vec3(two.x * q.y - two.z * q.w, 1.0 - two.x * q.x - two.z * q.z, two.y * q.z + two.x * q.w),
                r.z * vec3(two.x * q.z + two.y * q.w, two.y * q.z - two.x * q.w, 1.0 - two.x * q.x - two.y * q.y));
}
