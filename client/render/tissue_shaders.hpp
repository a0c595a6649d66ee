// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Tissue: wrapped diffuse light per channel stands for scattering beneath the surface (red travels
/// farthest), under a clear wet coat.
inline constexpr std::string_view tissue_fragment = R"(
in vec4 colour_at;
void main() {
    vec3 n = normalize(normal_at);
    vec3 v = normalize(eye - world);
    float wet = colour_at.a;
    vec3 albedo = colour_at.rgb;
    vec3 sum = albedo * ambient(n);
    const vec3 wrap = vec3(0.40, 0.18, 0.13);
    for (int i = 0; i < 2; ++i) {
        Arriving light = arriving(i);
        float nl = dot(n, light.direction);
        vec3 diffuse = max((nl + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
        vec3 h = normalize(light.direction + v);
        float nh = clamp(dot(n, h), 0.0, 1.0);
        float nh4 = nh * nh * nh * nh;
        float nh16 = nh4 * nh4 * nh4 * nh4;
        float nh128 = nh16 * nh16;
        nh128 = nh128 * nh128;
        nh128 = nh128 * nh128;
        float grazing = 1.0 - clamp(dot(v, h), 0.0, 1.0);
        float fresnel = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
        float facing = clamp(4.0 * nl, 0.0, 1.0);
        float coat = fresnel * facing * (1.2 * nh16 + wet * 16.0 * nh128);
        sum += light.colour * (albedo * diffuse + coat);
    }
    float rim = 1.0 - clamp(dot(n, v), 0.0, 1.0);
    sum += (0.03 + 0.12 * wet) * rim * rim * rim * ambient(reflect(-v, n));
    pixel = vec4(min(sum, brightest), 1.0);
}
)";

}  // namespace eti::render::source
