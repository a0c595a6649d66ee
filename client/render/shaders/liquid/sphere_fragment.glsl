// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A liquid sphere: distance [m] from the camera plane to its surface. Defines: THICKNESS (path
// length through the sphere [mm] instead).
in vec3 centre;
flat in float size;
#include "liquid/camera_depth.glsl"
out float value;
void main() {
    vec2 c = 2.0 * gl_PointCoord - 1.0;
    float squared = dot(c, c);
    if (squared > 1.0) {
        discard;
    }
    float front = size * sqrt(1.0 - squared);
#ifdef THICKNESS
    value = 2000.0 * front;
#else
    float z = centre.z + front;
    value = -z;
    gl_FragDepth = depth_at(z);
#endif
}
