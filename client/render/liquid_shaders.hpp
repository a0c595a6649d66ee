// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// A particle as a point that covers its sphere. STRING: one of POINTS along a thread, which is thicker where
/// it hangs on and sags a little, with a bead in its middle as viscoelastic threads have.
inline constexpr std::string_view sphere_vertex = R"(
#ifdef STRING
layout(location = 0) in vec4 from;      // place [m], radius of the thread [m]
layout(location = 1) in vec4 to;        // place [m], what the bead adds to the radius [m]
#else
layout(location = 0) in vec3 position;
layout(location = 1) in float share;    // of a whole sphere's radius
uniform float radius;       // [m]
#endif
uniform mat4 view;
uniform mat4 projection;
uniform vec4 clip_plane;
uniform float height;       // of the picture, pixels
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
    // Nothing of it sticks out of the cut.
    if (dot(clip_plane, vec4(position, 1.0)) < size) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
)";

/// Distance [m] from the camera's plane to the sphere; with THICKNESS the way [mm] through it.
inline constexpr std::string_view sphere_fragment = R"(
in vec3 centre;
flat in float size;
uniform mat4 projection;
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
    gl_FragDepth = 0.5 - 0.5 * (projection[2][2] * z + projection[3][2]) / z;
#endif
}
)";

/// One direction of a smoothing that does not mix near with far: a difference of more than a few radii is
/// another surface.
inline constexpr std::string_view smooth_fragment = R"(
in vec2 at;
uniform sampler2D depth;
uniform vec2 pixel;             // step to the next, along one direction
uniform float radius;           // [m]
uniform float sphere_pixels;    // across, of a sphere at one metre
uniform float width;            // to either side, in spheres
out float value;
void main() {
    float here = texture(depth, at).r;
    value = here;
    if (here <= 0.0) {
        return;
    }
    float stride = clamp(sphere_pixels / here * width / 6.0, 1.0, 8.0);
    float sum = here, weights = 1.0;
    for (int i = 1; i <= 6; ++i) {
        for (int side = -1; side <= 1; side += 2) {
            float other = texture(depth, at + float(i * side) * stride * pixel).r;
            float apart = (other - here) / (2.0 * radius);
            float weight = other > 0.0 ? exp(-float(i * i) / 12.0 - apart * apart) : 0.0;
            sum += weight * other;
            weights += weight;
        }
    }
    value = sum / weights;
}
)";

/// Goes before the lighting: the surface's place is computed, and where it lies in shadow maps.
inline constexpr std::string_view liquid_surface_inputs = R"(
#define LOOKED_UP
in vec2 at;
vec3 world;
layout(location = 0, index = 1) out vec4 transmitted;   // of what was drawn before
)";

/// The surface over what was drawn before, of which each colour comes through by its own share.
inline constexpr std::string_view liquid_surface_fragment = R"(
uniform sampler2D depth;
uniform sampler2D thickness;
uniform mat4 projection;
uniform mat4 to_world;
uniform vec2 next_pixel;
uniform float sphere_pixels;    // across, of a sphere at one metre
uniform float radius;           // [m]
uniform vec3 extinction;        // [1/mm]
uniform float deepest;          // [mm]
uniform vec3 albedo;
#ifdef ROOM_SHADOW
uniform mat4 room_lookup;
#endif
vec3 place(vec2 where) {
    float z = texture(depth, where).r;
    vec2 aside = vec2(projection[2][0], projection[2][1]);  // of a lens that is not centred
    return vec3((2.0 * where - 1.0 + aside) * z / vec2(projection[0][0], projection[1][1]), -z);
}
// Between both neighbours, but where one of them lies on another surface. Threads are narrower than `aside`:
// then between the next pixels, and level where there are none either.
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
    gl_FragDepth = 0.5 - 0.5 * (projection[2][2] * p.z + projection[3][2]) / p.z;
    // Over a third of a sphere's radius: what smoothing leaves from pixel to pixel does not show.
    vec2 aside = max(1.0, round(sphere_pixels / -p.z / 6.0)) * next_pixel;
    vec3 n = mat3(to_world) * normalize(cross(slope(p, vec2(aside.x, 0.0), vec2(next_pixel.x, 0.0)),
                                             slope(p, vec2(0.0, aside.y), vec2(0.0, next_pixel.y))));
    world = (to_world * vec4(p, 1.0)).xyz;
#ifdef ROOM_SHADOW
    room_at = (room_lookup * vec4(world, 1.0)).xyz;
#endif
#ifdef LAMP_SHADOW
    lamp_at = lamp_texel(world);
#endif
    vec3 v = normalize(eye - world);
    float open = open_at(world);
    float through = texture(thickness, at).r;
    float edge = smoothstep(0.05, 0.5, through);
    float nv = clamp(dot(n, v), 0.0, 1.0);
    // Less at the rim than a smooth sphere's: what is mirrored there is the throat, not the room.
    float fresnel = 0.02 + 0.35 * pow(1.0 - nv, 5.0);
    vec3 clear = exp(-extinction * min(through, deepest));
    vec3 scattered = 1.2 * albedo * open * ambient(n);
    vec3 mirrored = fresnel * 1.5 * open * ambient(reflect(-v, n));
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving(i);
#ifndef ROOM_SHADOW
        light.colour *= i == 0 ? open : 1.0;
#endif
        scattered += albedo * light.colour * (0.10 + 0.20 * max(dot(n, light.direction), 0.0));
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh8 = pow(nh, 8.0);
        float nh64 = pow(nh8, 8.0);
        mirrored += light.colour * (0.01 * nh8 * nh8 * nh8 + 0.25 * nh64 * nh64 * nh64 * nh64);
    }
    pixel = vec4(edge * min((1.0 - clear) * scattered + mirrored, brightest), 0.0);
    transmitted = vec4(1.0 - edge * (1.0 - clear * (1.0 - fresnel)), 1.0);
}
)";

}  // namespace eti::render::source
