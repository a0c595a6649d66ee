// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The liquid's surface, blended over the opaque scene with a transmittance per colour channel
// (dual-source blending). Defines: LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS, FINE (relief of a thin film), FROTH
// (at the edges of a liquid that foams; requires FINE).
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
#ifdef FINE
// A film follows the relief of the wet coat below, whose waves are 1 to 2 mm long.
vec3 relief(vec3 p) {
    p *= 3.7e3;
    return sin(p.yzx + 1.7 * sin(0.61 * p.zxy)) + 0.5 * sin(2.3 * p.zxy + 1.3 * sin(1.1 * p.xyz));
}
#endif
#ifdef FROTH
uniform vec3 froth;             // albedo
float hash(vec3 cell) { return fract(sin(dot(cell, vec3(12.9898, 78.233, 37.719))) * 43758.5453); }
// One layer of bubbles, one to a cell of `size` [m]: shells that are clear in the middle.
float bubbles(vec3 p, float size) {
    vec3 cell = floor(p / size), at = p / size - cell - 0.5;
    float which = hash(cell);
    at += 0.2 * (vec3(which, hash(cell + 7.0), hash(cell + 13.0)) - 0.5);
    float outward = length(at) / mix(0.22, 0.4, which);
    return (0.25 + 0.75 * outward * outward) * (1.0 - smoothstep(0.9, 1.0, outward));
}
#endif
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
    float edge = smoothstep(0.004, 0.06, through);
#ifdef FINE
    n = normalize(n + 0.07 * exp(-0.8 * through) * relief(world));
#endif
    float nv = clamp(dot(n, v), 0.0, 1.0);
    // Schlick, refractive index 1.35; a wet surface is not that of a perfect mirror at grazing angles.
    float fresnel = 0.022 + 0.6 * pow(1.0 - nv, 5.0);
    // Light passes down to the tissue and up again.
    vec3 clear = exp(-2.0 * extinction * min(through, deepest));
    vec3 body = albedo;
#ifdef FROTH
    float foamy = (1.0 - smoothstep(0.1, 0.7, through)) *
                  max(bubbles(world, 0.55e-3), bubbles(world + 0.19e-3, 0.3e-3));
    body = mix(body, froth, foamy);
    clear *= 1.0 - 0.7 * foamy;
#endif
    vec3 scattered = 1.2 * open * ambient(n);
    vec3 walls = vec3(0.0);
    vec3 shine = vec3(0.0);
    for (int i = 0; i < LIGHTS; ++i) {
        vec3 unshaded = unhindered(i, world).colour;
        Arriving light = arriving_through_mouth(i, open);
        scattered += light.colour * max((dot(n, light.direction) + 0.2) / 1.44, 0.0);
        walls += unshaded;
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh8 = pow(nh, 8.0);
        float nh64 = pow(nh8, 8.0);
        shine += light.colour * (0.01 * nh8 * nh8 * nh8 + 0.3 * nh64 * nh64 * nh64 * nh64);
    }
    // In a cavity the surface mirrors lit mucosa, outside the room.
    shine += fresnel * mix(vec3(0.34, 0.15, 0.13) * walls, 1.5 * mirrored(reflect(-v, n), 0.08), open);
    pixel = vec4(edge * min((1.0 - clear) * body * scattered + shine, brightest), 0.0);
    transmitted = vec4(1.0 - edge * (1.0 - clear * (1.0 - fresnel)), 1.0);
}
