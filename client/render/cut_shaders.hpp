// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Cut faces of the section: a quad over the plane, or the band along the contour.
inline constexpr std::string_view cut_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 colour;
uniform mat4 view_projection;
out vec3 world;
out vec3 colour_at;
void main() {
    world = position;
    colour_at = colour.rgb * colour.rgb * (0.75 + 0.25 * colour.rgb);
    gl_Position = view_projection * vec4(position, 1.0);
}
)";
inline constexpr std::string_view cut_fragment = R"(
in vec3 world;
in vec3 colour_at;
out vec4 pixel;
uniform float fibre;   // depth of the fibres' pattern, 0-1
float lattice(vec2 p) {   // Hoskins' hash without sine
    vec3 q = fract(p.xyx * 0.1031);
    q += dot(q, q.yzx + 33.33);
    return fract((q.x + q.y) * q.z);
}
float noise(vec2 p) {
    vec2 i = floor(p), f = fract(p);
    f = f * f * (3.0 - 2.0 * f);
    return mix(mix(lattice(i), lattice(i + vec2(1.0, 0.0)), f.x),
               mix(lattice(i + vec2(0.0, 1.0)), lattice(i + vec2(1.0, 1.0)), f.x), f.y);
}
void main() {
    vec3 c = colour_at;
    if (fibre > 0.0) {
        // Streaks of 0.4 by 4 mm across a mottle of 5 mm.
        float streak = noise(vec2(world.y * 250.0 + world.z * 90.0, (world.z * 2500.0 - world.y * 900.0)));
        float mottle = noise(world.yz * 200.0 + 7.0);
        c *= 1.0 + fibre * (0.5 * streak + 0.5 * mottle - 0.5);
    }
    pixel = vec4(c, 1.0);
}
)";

}  // namespace eti::render::source
