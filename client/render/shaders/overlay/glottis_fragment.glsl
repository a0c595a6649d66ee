// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The glottic opening as a tinted pane. Defines: none.
uniform vec4 tint;
out vec4 pixel;
void main() { pixel = tint; }
