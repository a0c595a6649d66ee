// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Linear light of a colour as stored with vertices. Draws nothing. Defines: none.
vec3 linear(vec3 c) { return c * c * (0.75 + 0.25 * c); }
