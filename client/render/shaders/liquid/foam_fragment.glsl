// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// A foam bubble as a thin shell: clear in the middle, white at the grazing rim, with a highlight of
// each light. Defines: LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS.
in vec3 world;
flat in vec3 centre;
flat in vec2 size;
#include "scene/lighting.glsl"
#include "scene/through_mouth.glsl"
#include "liquid/camera_depth.glsl"
uniform mat4 to_world;
uniform vec3 tint;
void main() {
    vec2 c = vec2(2.0, -2.0) * gl_PointCoord + vec2(-1.0, 1.0);
    float squared = dot(c, c);
    if (squared > 1.0) {
        discard;
    }
    vec3 outward = vec3(c, sqrt(1.0 - squared));
    float z = centre.z + size.x * outward.z;
    gl_FragDepth = depth_at(z);
    vec3 n = mat3(to_world) * outward;
    vec3 v = normalize(eye - world);
    float cover = size.y * (0.30 + 0.62 * squared * squared * (1.0 - 0.5 * smoothstep(0.8, 1.0, squared)));
    float open = open_at(world);
    vec3 sum = tint * open * ambient(n);
    vec3 glint = vec3(0.0);
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving_through_mouth(i, open);
        sum += tint * light.colour * (0.25 + 0.35 * max(dot(n, light.direction), 0.0));
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh8 = pow(nh, 8.0);
        glint += light.colour * 0.7 * nh8 * nh8 * nh8 * nh8 * nh8;
    }
    pixel = vec4(min(cover * sum + size.y * glint, brightest), cover);
}
