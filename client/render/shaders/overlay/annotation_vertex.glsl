// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// An annotation's ribbon, in clip coordinates. Defines: none.
layout(location = 0) in vec4 clipped;
void main() { gl_Position = clipped; }
