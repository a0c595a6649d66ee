// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Covers the viewport; draw four vertices as a strip.
inline constexpr std::string_view quad_vertex = R"(
out vec2 at;
void main() {
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * at - 1.0, 1.0, 1.0);
}
)";

/// COPY: values as they are.
inline constexpr std::string_view tone_fragment = R"(
in vec2 at;
out vec4 pixel;
uniform sampler2D light;
uniform float aspect;
uniform float exposure;
uniform float vignette;
uniform float fogging;
// Filmic curve of Narkowicz 2015; keeps highlights from clipping to flat white.
vec3 film(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
void main() {
    vec3 c = texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb;
#ifndef COPY
    vec2 corner = (2.0 * at - 1.0) * vec2(aspect, 1.0);
    float out_of_middle = length(corner);
    c *= exposure * (1.0 - vignette * 0.92 * smoothstep(0.75, 1.45, out_of_middle));
    // Droplets scatter what comes through and add light of their own.
    float fog = fogging * (1.0 - 0.6 * smoothstep(0.3, 1.3, out_of_middle));
    c = film(mix(c, vec3(0.30, 0.29, 0.29), 0.85 * fog));
#endif
    pixel = vec4(c, 1.0);
}
)";

}  // namespace eti::render::source
