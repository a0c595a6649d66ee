// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Functions for both stages of the tone pass: distance of a place from the picture's centre, 1 at
// its upper edge, and the vignette's share there. Draws nothing. Defines: none.
uniform float aspect;
float out_of_middle(vec2 place) { return length((2.0 * place - 1.0) * vec2(aspect, 1.0)); }
float in_corner(float out_of_middle) { return smoothstep(0.75, 1.45, out_of_middle); }
