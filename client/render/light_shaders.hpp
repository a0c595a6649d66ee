// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

namespace eti::render::source {

/// Lights and what they give at a place with nothing in their way; colours are linear. Defines: LIGHTS, of
/// which the second is the laryngoscope's lamp.
inline constexpr std::string_view lights = R"(
#ifndef LIGHTS
#define LIGHTS 2
#endif
uniform vec3 ambient_high;
uniform vec3 ambient_low;
uniform vec3 light_position[2];
uniform vec3 light_direction[2];
uniform vec3 light_colour[2];
uniform vec3 light_shape[2];   // cosines of outer and inner cone, square of the reach [m^2]

vec3 ambient(vec3 n) { return mix(ambient_low, ambient_high, 0.5 - 0.5 * n.y); }

struct Arriving { vec3 direction; vec3 colour; };

Arriving unhindered(int i, vec3 at) {
    vec3 way = light_position[i] - at;
    float squared = dot(way, way);
    vec3 l = way * inversesqrt(squared);
    float strength = smoothstep(light_shape[i].x, light_shape[i].y, dot(-l, light_direction[i]));
    return Arriving(l, light_colour[i] * (strength * light_shape[i].z / (light_shape[i].z + squared)));
}
)";

inline constexpr std::string_view shadows = R"(
layout(location = 0) out vec4 pixel;
// A glint outshines no more than this, or it would leave jagged edges where samples are averaged.
const vec3 brightest = vec3(8.0);
uniform vec3 eye;
uniform float occlusion;       // how much of the room hollows are kept from
#ifdef ROOM_SHADOW
in vec4 room_at;
uniform sampler2DShadow room_map;
#endif
#ifdef LAMP_SHADOW
in vec4 lamp_at;
uniform sampler2DShadow lamp_map;
#endif

#if defined(ROOM_SHADOW) || defined(LAMP_SHADOW)
// The share of a light that arrives, over TAPS x TAPS looks of two texels' breadth each.
float unshadowed(sampler2DShadow map, vec4 at) {
    vec3 p = at.xyz / at.w;
    float texel = 1.5 / float(textureSize(map, 0).x);
    float sum = 0.0;
    for (int y = 0; y < TAPS; ++y) {
        for (int x = 0; x < TAPS; ++x) {
            vec2 aside = vec2(x, y) - 0.5 * float(TAPS - 1);
            sum += texture(map, vec3(p.xy + aside * texel, p.z));
        }
    }
    return sum / float(TAPS * TAPS);
}
#endif

Arriving arriving(int i) {
    Arriving light = unhindered(i, world);
#ifdef ROOM_SHADOW
    if (i == 0) {
        light.colour *= unshadowed(room_map, room_at);
    }
#endif
#ifdef LAMP_SHADOW
    if (i == 1) {
        light.colour *= lamp_at.w > 0.0 ? unshadowed(lamp_map, lamp_at) : 0.0;
    }
#endif
    return light;
}
)";

/// What arrives at `world`: goes before what a fragment shader makes of it. Defines: those of `lights`;
/// ROOM_SHADOW, LAMP_SHADOW, TAPS.
inline const std::string lighting = std::string(lights) + std::string(shadows);

}  // namespace eti::render::source
