// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Covers the viewport; draw four vertices as a strip. TONE: finds how much light the film takes, too. A
/// camera that meters its own picture lets less in where that is too bright. The mean is over a grid of
/// points, without the corners that a vignette takes.
inline constexpr std::string_view quad_vertex = R"(
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
)";

/// Before both stages of the tone pass: where a place of the picture lies, 1 at its upper edge, and how much
/// of it a vignette takes.
inline constexpr std::string_view tone_corner = R"(
uniform float aspect;
float out_of_middle(vec2 place) { return length((2.0 * place - 1.0) * vec2(aspect, 1.0)); }
float in_corner(float out_of_middle) { return smoothstep(0.75, 1.45, out_of_middle); }
)";

/// Without TONE values as they are.
inline constexpr std::string_view tone_fragment = R"(
in vec2 at;
out vec4 pixel;
uniform sampler2D light;
#ifdef TONE
flat in float taken;
uniform float vignette;
uniform float fogging;
// Filmic curve of Narkowicz 2015; keeps highlights from clipping to flat white.
vec3 film(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
#endif
void main() {
    vec3 c = texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb;
#ifdef TONE
    float out_here = out_of_middle(at);
    c *= taken * (1.0 - vignette * 0.92 * in_corner(out_here));
    // Droplets scatter what comes through and add light of their own.
    float fog = fogging * (1.0 - 0.6 * smoothstep(0.3, 1.3, out_here));
    c = film(mix(c, vec3(0.30, 0.29, 0.29), 0.85 * fog));
#endif
    pixel = vec4(c, 1.0);
}
)";

}  // namespace eti::render::source
