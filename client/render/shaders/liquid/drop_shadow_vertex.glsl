// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A separate drop as a point sprite in a shadow map. Particles of films and pools, which are flat, cast none: what
// they would shade lies beneath them. Defines: FROM_LAMP (into the lamp's map).
#include "scene/lamp_map.glsl"
#include "liquid/ellipsoid.glsl"
uniform mat4 view_projection;
uniform float texels;       // of the map, per side
void main() {
    vec3 p = ellipsoid_centre();
    float r = radii.x * largest;
    bool casts = radii.x > 0.75 * radii.z;
#ifdef FROM_LAMP
    vec4 at = in_lamp_map(p);
    vec3 q = (to_lamp * vec4(p, 1.0)).xyz;
    float scale = 1.0 / max(length(q) + q.z, 1e-4), deeper = 1.0 / (lamp_depths.y - lamp_depths.x);
    gl_Position = vec4(at.xy, 2.0 * (at.z + 0.5 * r * deeper) - 1.0, 1.0);
    gl_ClipDistance[0] = at.w;
    // Nearer to the lamp, whose glass is as wide as a drop, the shadow would be all penumbra.
    casts = casts && length(q) > 8e-3;
#else
    vec3 along = vec3(view_projection[0][2], view_projection[1][2], view_projection[2][2]);
    float scale = length(vec3(view_projection[0][0], view_projection[1][0], view_projection[2][0]));
    gl_Position = view_projection * vec4(p, 1.0);
    gl_Position.z += 0.5 * r * length(along);
#endif
    gl_PointSize = max(texels * scale * r, 1.0);
    if (!casts) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
