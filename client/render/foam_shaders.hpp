// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// A bubble as a point that covers it, on the liquid's surface: particles lie beneath that.
inline constexpr std::string_view foam_vertex = R"(
layout(location = 0) in vec4 bubble;    // from `origin` [m], radius [m]
uniform vec3 origin;
uniform mat4 view;
uniform mat4 projection;
uniform vec4 clip_plane;
uniform float lift;         // [m], of the surface over the particles
uniform float height;       // of the picture, pixels
out vec3 world;
#ifdef ROOM_SHADOW
uniform mat4 room_lookup;
out vec3 room_at;
#endif
#ifdef LAMP_SHADOW
out vec3 lamp_at;
#endif
flat out vec3 centre;
flat out vec2 size;         // radius [m], share of the point that it covers
void main() {
    world = origin + bubble.xyz;
#ifdef ROOM_SHADOW
    room_at = (room_lookup * vec4(world, 1.0)).xyz;
#endif
#ifdef LAMP_SHADOW
    lamp_at = lamp_texel(world);
#endif
    vec4 p = view * vec4(world, 1.0);
    p.z += lift;
    centre = p.xyz;
    gl_Position = projection * p;
    float across = height * projection[1][1] * bubble.w / gl_Position.w;
    gl_PointSize = max(across, 1.5);
    size = vec2(bubble.w, min(across * across / 2.25, 1.0));
    if (dot(clip_plane, vec4(world, 1.0)) < bubble.w) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
}
)";

/// Goes before the lighting.
inline constexpr std::string_view foam_inputs = R"(
in vec3 world;
flat in vec3 centre;
flat in vec2 size;
)";

/// A thin shell: clear in the middle, white at the rim, where one looks along it, and a glint of each light.
inline constexpr std::string_view foam_fragment = R"(
uniform mat4 projection;
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
    gl_FragDepth = 0.5 - 0.5 * (projection[2][2] * z + projection[3][2]) / z;
    vec3 n = mat3(to_world) * outward;
    vec3 v = normalize(eye - world);
    float cover = size.y * (0.30 + 0.62 * squared * squared * (1.0 - 0.5 * smoothstep(0.8, 1.0, squared)));
    float open = open_at(world);
    vec3 sum = tint * open * ambient(n);
    vec3 glint = vec3(0.0);
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving(i);
#ifndef ROOM_SHADOW
        light.colour *= i == 0 ? open : 1.0;
#endif
        sum += tint * light.colour * (0.25 + 0.35 * max(dot(n, light.direction), 0.0));
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh8 = pow(nh, 8.0);
        glint += light.colour * 0.7 * nh8 * nh8 * nh8 * nh8 * nh8;
    }
    pixel = vec4(min(cover * sum + size.y * glint, brightest), cover);
}
)";

}  // namespace eti::render::source
