// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A liquid ellipsoid: distance [m] from the camera plane to its surface. Defines: THICKNESS (path
// length through it [mm] instead).
in vec3 centre;
flat in vec3 shape;
flat in vec2 lean;
flat in vec2 depths;
#include "liquid/camera_depth.glsl"
out float value;
void main() {
    vec2 c = vec2(2.0, -2.0) * gl_PointCoord + vec2(-1.0, 1.0);
    float inside = 1.0 - dot(shape, vec3(c.x * c.x, c.x * c.y, c.y * c.y));
    if (inside < 0.0) {
        discard;
    }
#ifdef THICKNESS
    value = depths.y * inside * inside;
#else
    float z = centre.z + dot(lean, c) + depths.x * sqrt(inside);
    value = -z;
    gl_FragDepth = depth_at(z);
#endif
}
