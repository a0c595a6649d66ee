// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Linear blend skinning by transform feedback, followed by displacement by breath and blade; include after
// blade_clearance_source() and `chest_rise`. Defines: GROUPS (groups of four frames per vertex), FIRST_WEIGHT
// (location of the first weight attribute).
layout(location = 0) in vec3 rest_position;
layout(location = 1) in vec3 rest_normal;
layout(location = 2) in uvec4 frame[GROUPS];
layout(location = FIRST_WEIGHT) in vec4 weight[GROUPS];
uniform samplerBuffer frames;   // three rows per frame: linear part and offset
uniform int blade_held;
out vec3 skinned_position;
out vec3 skinned_normal;
void main() {
    vec4 row0 = vec4(0.0), row1 = vec4(0.0), row2 = vec4(0.0);
    for (int group = 0; group < GROUPS; ++group) {
        for (int k = 0; k < 4; ++k) {
            float w = weight[group][k];
            int at = 3 * int(frame[group][k]);
            row0 += w * texelFetch(frames, at);
            row1 += w * texelFetch(frames, at + 1);
            row2 += w * texelFetch(frames, at + 2);
        }
    }
    vec4 p = vec4(rest_position, 1.0);
    vec3 carried = vec3(dot(row0, p), dot(row1, p), dot(row2, p));
    // Normals transform by the cofactor matrix, as blended frames can shear and squeeze.
    vec3 n = vec3(dot(cross(row1.xyz, row2.xyz), rest_normal), dot(cross(row2.xyz, row0.xyz), rest_normal),
                  dot(cross(row0.xyz, row1.xyz), rest_normal));
    n *= inversesqrt(max(dot(n, n), 1e-20));
    // The trunk keeps the orientation of the rest posture.
    carried.y -= chest_rise(rest_position);
    skinned_position = carried;
    skinned_normal = n;
    if (blade_held != 0) {
        skinned_position = give_way(carried);
        if (skinned_position != carried) {
            // The normal rotates with its surroundings.
            const float apart = 0.2e-3;
            vec3 aside = normalize(cross(n, abs(n.y) < 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
            vec3 turned = cross(give_way(carried + apart * aside) - skinned_position,
                                give_way(carried + apart * cross(n, aside)) - skinned_position);
            skinned_normal = dot(turned, turned) > 0.0 ? normalize(turned) : n;
        }
    }
}
