// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A quad that covers the viewport; draw four vertices as a strip. Defines: TONE (also computes the
// exposure: automatic exposure reduces it for bright pictures, by the mean over a grid of points
// without the corners that a vignette darkens).
#ifdef TONE
#include "overlay/tone_corner.glsl"
#endif
out vec2 at;
#ifdef TONE
flat out float taken;
uniform sampler2D light;
uniform vec4 area;
uniform float exposure;
uniform float metered;
float mean_light() {
    const ivec2 points = ivec2(24, 14);
    vec2 sum = vec2(0.0);
    for (int i = 0; i < points.x * points.y; ++i) {
        vec2 place = (vec2(i % points.x, i / points.x) + 0.5) / vec2(points);
        vec3 c = texelFetch(light, ivec2(area.xy + place * area.zw), 0).rgb;
        float weight = 1.0 - in_corner(out_of_middle(place));
        sum += weight * vec2(min(dot(c, vec3(0.2126, 0.7152, 0.0722)), 4.0), 1.0);
    }
    return sum.x / sum.y;
}
#endif
void main() {
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * at - 1.0, 1.0, 1.0);
#ifdef TONE
    taken = metered > 0.0 ? exposure * min(metered / max(mean_light(), 1e-6), 1.0) : exposure;
#endif
}
