// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Brushed steel: mostly mirrors a bright ceiling over dark surroundings.
inline constexpr std::string_view metal_fragment = R"(
in vec4 colour_at;
uniform float opacity;
uniform mat4 model;
float lattice(float x) { return fract(sin(x * 12.9898) * 43758.5453); }
void main() {
    vec3 n = normalize(normal_at);
    vec3 v = normalize(eye - world);
    // Brushed lengthwise: streaks half a millimetre wide across the tool.
    float across = dot(model[0].xyz, world - model[3].xyz) * 2000.0;
    float streak = mix(lattice(floor(across)), lattice(floor(across) + 1.0), smoothstep(0.0, 1.0, fract(across)));
    vec3 mirrored = reflect(-v, n);
    float ceiling = smoothstep(-0.5, 0.9, -mirrored.y);
    vec3 steel = colour_at.rgb * (0.90 + 0.16 * streak);
    float rim = 1.0 - clamp(dot(n, v), 0.0, 1.0);
    // What the lamps light around the steel, mirrored in it, more so at a grazing angle.
    vec3 surroundings = (0.10 + 0.25 * rim * rim) * light_colour[0] + 0.06 * light_colour[1];
    vec3 sum = steel * (mix(1.2 * ambient_low, 2.2 * ambient_high, ceiling) + surroundings);
    for (int i = 0; i < 2; ++i) {
        Arriving light = arriving(i);
        float nl = dot(n, light.direction);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh4 = nh * nh * nh * nh;
        float nh16 = nh4 * nh4 * nh4 * nh4;
        sum += light.colour * steel * max(nl, 0.0) * (0.25 + 0.35 * nh4 + 1.4 * nh16 * nh16);
    }
    pixel = vec4(min(sum, brightest), opacity);
}
)";

/// Clear plastic with a radio-opaque line, a mark every centimetre from the tip, the black band that
/// is to lie at the cords, and the connector behind the tube's end.
inline constexpr std::string_view tube_fragment = R"(
in vec2 course_at;
uniform float tube_length;
uniform float opacity;
void main() {
    vec3 n = normalize(normal_at);
    vec3 v = normalize(eye - world);
    float rim = 1.0 - abs(dot(n, v));
    vec3 albedo = vec3(0.62, 0.76, 0.86);
    float cover = 0.42 + 0.45 * rim * rim;
    float centimetres = course_at.x * 100.0;
    float from_mark = abs(fract(centimetres + 0.5) - 0.5) / 100.0;
    float turn = abs(fract(course_at.y + 0.5) - 0.5);
    float line = 1.0 - smoothstep(0.030, 0.045, turn);
    float mark = (1.0 - smoothstep(0.00025, 0.0005, from_mark)) * step(0.5, centimetres) * step(turn, 0.27);
    float band = smoothstep(0.0205, 0.021, course_at.x) * (1.0 - smoothstep(0.0225, 0.023, course_at.x));
    float ink = max(max(mark, 0.85 * line), band);
    vec3 ink_colour = mix(vec3(0.03, 0.10, 0.35), vec3(0.01, 0.012, 0.02), band);
    float hub = step(tube_length, course_at.x);
    albedo = mix(mix(albedo, ink_colour, ink), vec3(0.10, 0.28, 0.62), hub);
    cover = max(cover, max(0.92 * ink, hub));
    vec3 sum = albedo * ambient(n);
    float shine = 0.0;
    for (int i = 0; i < 2; ++i) {
        Arriving light = arriving(i);
        float nl = 0.5 + 0.5 * dot(n, light.direction);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh4 = nh * nh * nh * nh;
        float nh16 = nh4 * nh4 * nh4 * nh4;
        float gloss = nh16 * nh16 * nh16 * nh16;
        sum += light.colour * (albedo * nl * nl + 0.9 * gloss);
        shine += gloss;
    }
    pixel = vec4(min(sum, brightest), opacity * clamp(cover + 0.5 * shine, 0.0, 1.0));
}
)";

}  // namespace eti::render::source
