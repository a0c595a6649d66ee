// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A liquid particle as a point sprite that covers its ellipsoid. Defines: STRING (one of POINTS points
// along a filament, which is thicker at its attachments, sags a little and has a bead in its
// middle, as viscoelastic filaments do), POINTS.
#ifdef STRING
layout(location = 0) in vec4 from;      // position [m], radius of the filament [m]
layout(location = 1) in vec4 to;        // position [m], additional radius of the bead [m]
#else
#include "liquid/ellipsoid.glsl"
uniform float particle_volume;          // [m^3]
#endif
uniform mat4 view;
uniform mat4 projection;
uniform vec4 clip_plane;
uniform float height;       // of the picture [pixels]
out vec3 centre;
// The surface in camera coordinates is lean.c + half_depth * sqrt(1 - shape.(cx^2, cx cy, cy^2)) in front of the
// centre, where c is the place in the sprite from -1 to 1.
flat out vec3 shape;
flat out vec2 lean;         // [m]
flat out vec2 depths;       // half_depth [m]; path length in the middle [mm]
void main() {
#ifdef STRING
    float t = float(gl_VertexID) / float(POINTS - 1), aside = 2.0 * t - 1.0;
    vec3 way = to.xyz - from.xyz;
    vec3 position = from.xyz + t * way + vec3(0.0, 0.06 * length(way.xz) * (1.0 - aside * aside), 0.0);
    float end = aside * aside * aside * aside;
    float size = from.w * (1.0 + 2.0 * end * end) + to.w * exp(-60.0 * aside * aside);
    mat3 axes = mat3(size);
    // A cylinder's share of each point.
    float volume = 3.14159 * size * size * length(way) / float(POINTS);
    float own = 4.18879 * size * size * size;
#else
    vec3 position = ellipsoid_centre();
    vec3 r = radii * largest;
    float size = r.z;
    mat3 axes = mat3(view) * ellipsoid_axes(r);
    float volume = particle_volume;
    float own = 4.18879 * r.x * r.y * r.z;
#endif
    vec4 p = view * vec4(position, 1.0);
    centre = p.xyz;
    // Perspective near the centre shears the ellipsoid along the ray (Zwicker et al. 2001).
    vec2 ray = p.xy / -p.z;
    for (int k = 0; k < 3; ++k) {
        axes[k].xy += ray * axes[k].z;
    }
    mat3 rows = transpose(axes);
    float uu = dot(rows[0], rows[0]), uv = dot(rows[0], rows[1]), vv = dot(rows[1], rows[1]);
    vec2 w = vec2(dot(rows[0], rows[2]), dot(rows[1], rows[2]));
    float det = uu * vv - uv * uv, reach = sqrt(max(uu, vv));
    vec2 slope = vec2(w.x * vv - w.y * uv, w.y * uu - w.x * uv) / det;
    shape = uu * vv > 0.0 ? reach * reach / det * vec3(vv, -2.0 * uv, uu) : vec3(2.0);
    lean = reach * slope;
    float half_depth = sqrt(max(dot(rows[2], rows[2]) - dot(w, slope), 0.0));
    // The path falls off as the square of the ellipsoid's own, which leaves no rims where particles overlap; twice
    // its length keeps the volume.
    depths = vec2(half_depth, 4000.0 * half_depth * sqrt(1.0 + dot(ray, ray)) * volume / own);
    gl_Position = projection * p;
    float across = height * projection[1][1] * reach / gl_Position.w;
    gl_PointSize = max(across, 1.0);
    depths.y *= min(across * across, 1.0);      // of the pixel, where that is larger
    // Nothing protrudes from the section plane.
    if (dot(clip_plane, vec4(position, 1.0)) < size) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
