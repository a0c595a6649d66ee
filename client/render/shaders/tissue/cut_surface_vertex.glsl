// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Corners of a skinned surface's triangles, for cut_geometry. Defines: FAN (positions only).
layout(location = 0) in vec3 position;
#ifndef FAN
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
out vec3 corner_normal;
out vec3 corner_colour;
#endif
uniform vec4 plane;       // points with dot(xyz, p) + w >= 0 are kept
out vec4 corner;          // position, signed distance to the plane
flat out int corner_index;
void main() {
    corner = vec4(position, dot(plane.xyz, position) + plane.w);
    corner_index = gl_VertexID;
#ifndef FAN
    corner_normal = normal;
    corner_colour = colour.rgb;
#endif
}
