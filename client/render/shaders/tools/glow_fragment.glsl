// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Light scattered around the bulb, added to the picture: brightest in the middle of an enclosing shell. Defines: none.
in vec3 world;
in vec3 normal_at;
uniform vec3 eye;
uniform vec3 glow;
out vec4 pixel;
void main() {
    float facing = clamp(dot(normalize(normal_at), normalize(eye - world)), 0.0, 1.0);
    pixel = vec4(glow * facing * facing * facing * facing, 0.0);
}
