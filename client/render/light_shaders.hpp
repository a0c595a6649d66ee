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
uniform float occlusion;       // how much of the room hollows are kept from
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

/// Where a point lies in the lamp's shadow map: a paraboloid shows the half of the room before the lamp as a
/// disc that is hardly finer at its rim than in its middle (Brabec et al. 2002). A flat map of this lamp's
/// cone would spend nine tenths of its texels on rays more than 64 degrees from the axis.
inline constexpr std::string_view lamp_map = R"(
#if defined(LAMP_SHADOW) || defined(FROM_LAMP)
uniform mat4 to_lamp;        // its third axis along the light
uniform vec2 lamp_depths;    // the least and the most that are told apart [m]
// The disc from -1 to 1; the depth from 0 to 1; how far [m] it lies before the lamp.
vec4 in_lamp_map(vec3 p) {
    vec3 q = (to_lamp * vec4(p, 1.0)).xyz;
    float away = length(q);
    return vec4(q.xy / max(away + q.z, 1e-6), (away - lamp_depths.x) / (lamp_depths.y - lamp_depths.x), q.z);
}
vec3 lamp_texel(vec3 p) {
    vec4 at = in_lamp_map(p);
    return vec3(0.5 + 0.5 * at.xy, at.z);
}
#endif
)";

/// What of a light that throws shadows arrives. Defines: ROOM_SHADOW, LAMP_SHADOW, TAPS; LOOKED_UP, empty
/// where the shader itself computes places in shadow maps.
inline constexpr std::string_view shadows = R"(
#ifndef LOOKED_UP
#define LOOKED_UP in
#endif
layout(location = 0) out vec4 pixel;
// A glint outshines no more than this, or it would leave jagged edges where samples are averaged.
const vec3 brightest = vec3(8.0);
uniform vec3 eye;
#ifdef ROOM_SHADOW
LOOKED_UP vec3 room_at;
uniform sampler2DShadow room_depth;
#endif
#ifdef LAMP_SHADOW
LOOKED_UP vec3 lamp_at;
uniform sampler2DShadow lamp_depth;
#endif

#if defined(ROOM_SHADOW) || defined(LAMP_SHADOW)
// The share of a light that arrives, over TAPS x TAPS looks of two texels' breadth each.
float unshadowed(sampler2DShadow map, vec3 p) {
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
)";

inline constexpr std::string_view arrivals = R"(
// The share of a light with nothing in its way.
float reaching(int i) {
#ifdef ROOM_SHADOW
    if (i == 0) {
        return unshadowed(room_depth, room_at);
    }
#endif
#ifdef LAMP_SHADOW
    if (i == 1) {
        return unshadowed(lamp_depth, lamp_at);
    }
#endif
    return 1.0;
}
Arriving arriving(int i) {
    Arriving light = unhindered(i, world);
    light.colour *= reaching(i);
    return light;
}
)";

/// What arrives at `world`: goes before what a fragment shader makes of it. Defines: those of `lights` and
/// `shadows`.
inline const std::string lighting = std::string(lights) + std::string(shadows) + std::string(arrivals);

/// How much of the room's light comes in through the mouth; goes after the lighting.
inline constexpr std::string_view through_mouth = R"(
uniform vec4 mouth;   // middle between the gums, half the way between them [m]
uniform vec3 inward;  // from there to the larynx
float open_at(vec3 p) {
    // A disc over who lies beneath its middle: its view factor.
    float depth = max(dot(p - mouth.xyz, inward), 0.0);
    return mix(1.0, mouth.w * mouth.w / (mouth.w * mouth.w + depth * depth), occlusion);
}
)";

}  // namespace eti::render::source
