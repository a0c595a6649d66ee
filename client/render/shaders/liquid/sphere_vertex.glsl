// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A liquid particle as a point sprite that covers its sphere. Defines: STRING (one of POINTS points
// along a filament, which is thicker at its attachments, sags a little and has a bead in its
// middle, as viscoelastic filaments do), POINTS.
#ifdef STRING
layout(location = 0) in vec4 from;      // position [m], radius of the filament [m]
layout(location = 1) in vec4 to;        // position [m], additional radius of the bead [m]
#else
layout(location = 0) in vec3 position;
layout(location = 1) in float share;    // of a full sphere's radius
uniform float radius;       // [m]
#endif
uniform mat4 view;
uniform mat4 projection;
uniform vec4 clip_plane;
uniform float height;       // of the picture [pixels]
out vec3 centre;
flat out float size;        // radius [m]
void main() {
#ifdef STRING
    float t = float(gl_VertexID) / float(POINTS - 1), aside = 2.0 * t - 1.0;
    vec3 way = to.xyz - from.xyz;
    vec3 position = from.xyz + t * way + vec3(0.0, 0.06 * length(way.xz) * (1.0 - aside * aside), 0.0);
    float end = aside * aside * aside * aside;
    size = from.w * (1.0 + 2.0 * end * end) + to.w * exp(-60.0 * aside * aside);
#else
    size = share * radius;
#endif
    vec4 p = view * vec4(position, 1.0);
    centre = p.xyz;
    gl_Position = projection * p;
    gl_PointSize = max(height * projection[1][1] * size / gl_Position.w, 1.0);
    // Nothing protrudes from the section plane.
    if (dot(clip_plane, vec4(position, 1.0)) < size) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
