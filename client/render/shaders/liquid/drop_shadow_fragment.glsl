// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The round outline of a drop in a shadow map. Defines: none.
void main() {
    vec2 c = 2.0 * gl_PointCoord - 1.0;
    if (dot(c, c) > 1.0) {
        discard;
    }
}
