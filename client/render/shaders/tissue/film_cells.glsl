// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Cells of a cube of SIDE^3 voxels, stored as a 2-D atlas of layers, ROW per row. Draws nothing.
// Defines: SIDE, ROW.
uniform vec3 low;       // corner of the cube [m]
uniform float cell;     // [m]
ivec2 pixel_of(ivec3 at) { return ivec2(at.z % ROW, at.z / ROW) * SIDE + at.xy; }
bool outside(ivec3 at) { return any(lessThan(at, ivec3(0))) || any(greaterThanEqual(at, ivec3(SIDE))); }
