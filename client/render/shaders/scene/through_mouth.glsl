// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Fraction of the ambient light that enters through the mouth; include after the lighting. Defines:
// none.
uniform vec4 mouth;   // midpoint between the gums, half their distance [m]
uniform vec3 inward;  // direction to the larynx
float open_at(vec3 p) {
    // View factor of a disc from a point below its centre.
    float depth = max(dot(p - mouth.xyz, inward), 0.0);
    return mix(1.0, mouth.w * mouth.w / (mouth.w * mouth.w + depth * depth), occlusion);
}
