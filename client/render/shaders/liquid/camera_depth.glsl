// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Depth buffer value of a point at `z` [m] in camera coordinates. Draws nothing. Defines: none.
uniform mat4 projection;
float depth_at(float z) { return 0.5 - 0.5 * (projection[2][2] * z + projection[3][2]) / z; }
