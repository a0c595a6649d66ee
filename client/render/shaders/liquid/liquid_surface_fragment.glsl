// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The liquid's surface, blended over the opaque scene with a transmittance per colour channel
// (dual-source blending). Defines: LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS.
#define LOOKED_UP
in vec2 at;
vec3 world;
layout(location = 0, index = 1) out vec4 transmitted;   // of the opaque scene
#include "scene/lighting.glsl"
#include "scene/through_mouth.glsl"
#include "scene/shadow_places.glsl"
#include "liquid/camera_depth.glsl"
uniform sampler2D depth;
uniform sampler2D thickness;
uniform mat4 to_world;
uniform vec2 next_pixel;
uniform float sphere_pixels;    // diameter of a sphere at one metre
uniform float radius;           // [m]
uniform vec3 extinction;        // [1/mm]
uniform float deepest;          // [mm]
uniform vec3 albedo;
vec3 place(vec2 where) {
    float z = texture(depth, where).r;
    vec2 aside = vec2(projection[2][0], projection[2][1]);  // for an off-axis lens
    return vec3((2.0 * where - 1.0 + aside) * z / vec2(projection[0][0], projection[1][1]), -z);
}
// Central difference, or one-sided where one of the neighbours lies on another surface. Filaments
// are narrower than `aside`: they use the adjacent pixels, and are level where those are empty too.
vec3 slope(vec3 p, vec2 aside, vec2 next) {
    vec3 after = place(at + aside), before = place(at - aside);
    if (after.z >= 0.0 && before.z >= 0.0) {
        after = place(at + next);
        before = place(at - next);
        if (after.z >= 0.0 && before.z >= 0.0) {
            return vec3(2.0 * next * -p.z / vec2(projection[0][0], projection[1][1]), 0.0);
        }
    }
    after -= p;
    before = p - before;
    if (abs(after.z - before.z) < radius) {
        return 0.5 * (after + before);
    }
    return abs(before.z) < abs(after.z) ? before : after;
}
void main() {
    vec3 p = place(at);
    if (p.z >= 0.0) {
        discard;
    }
    gl_FragDepth = depth_at(p.z);
    // Over a third of a sphere's radius, which hides the pixel noise that smoothing leaves.
    vec2 aside = max(1.0, round(sphere_pixels / -p.z / 6.0)) * next_pixel;
    vec3 n = mat3(to_world) * normalize(cross(slope(p, vec2(aside.x, 0.0), vec2(next_pixel.x, 0.0)),
                                             slope(p, vec2(0.0, aside.y), vec2(0.0, next_pixel.y))));
    world = (to_world * vec4(p, 1.0)).xyz;
    place_in_shadow_maps(world);
    vec3 v = normalize(eye - world);
    float open = open_at(world);
    float through = texture(thickness, at).r;
    float edge = smoothstep(0.05, 0.5, through);
    float nv = clamp(dot(n, v), 0.0, 1.0);
    // Weaker at the rim than a smooth sphere's: it reflects the throat, not the room.
    float fresnel = 0.02 + 0.35 * pow(1.0 - nv, 5.0);
    vec3 clear = exp(-extinction * min(through, deepest));
    vec3 scattered = 1.2 * albedo * open * ambient(n);
    vec3 mirrored = fresnel * 1.5 * open * mirrored(reflect(-v, n), 0.08);
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving_through_mouth(i, open);
        scattered += albedo * light.colour * (0.10 + 0.20 * max(dot(n, light.direction), 0.0));
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh8 = pow(nh, 8.0);
        float nh64 = pow(nh8, 8.0);
        mirrored += light.colour * (0.01 * nh8 * nh8 * nh8 + 0.25 * nh64 * nh64 * nh64 * nh64);
    }
    pixel = vec4(edge * min((1.0 - clear) * scattered + mirrored, brightest), 0.0);
    transmitted = vec4(1.0 - edge * (1.0 - clear * (1.0 - fresnel)), 1.0);
}
