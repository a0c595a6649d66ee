// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// An annotation's ribbon in one colour. Defines: none.
uniform vec4 colour;
out vec4 pixel;
void main() { pixel = colour; }
