// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A section's faces: the plane with the fibre pattern of the tissue, and the contour's band
// unchanged. Defines: none.
in vec3 world;
in vec3 colour_at;
out vec4 pixel;
uniform float fibre;   // amplitude of the fibre pattern, 0-1
uniform sampler2D grain;   // noise, 128 cells per period
void main() {
    vec3 c = colour_at;
    if (fibre > 0.0) {
        // Streaks of 0.4 by 4 mm across a mottle of 5 mm.
        float streak = texture(grain, vec2(world.y * 250.0 + world.z * 90.0, world.z * 2500.0 - world.y * 900.0) / 128.0).r;
        float mottle = texture(grain, (world.yz * 200.0 + 7.0) / 128.0).r;
        c *= 1.0 + fibre * (0.5 * streak + 0.5 * mottle - 0.5);
    }
    pixel = vec4(c, 1.0);
}
