// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// All meshes. Defines: TUBE (course in place of colour), SHADOW (also looks up the key light's depth),
/// RETRACT (lips held aside, see LipRetraction).
inline constexpr std::string_view mesh_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
#ifdef TUBE
layout(location = 3) in vec2 course;
out vec2 course_at;
#else
layout(location = 2) in vec4 colour;
out vec4 colour_at;
#endif
uniform mat4 model;
uniform mat4 view_projection;
uniform vec4 clip_plane;
out vec3 world;
out vec3 normal_at;
#ifdef SHADOW
uniform mat4 shadow_matrix;
out vec3 shadow_at;
#endif
#ifdef RETRACT
uniform mat4 to_sight;
uniform vec3 sight_up;
uniform vec2 lip_shift;   // upper lip downwards, lower lip upwards [m]
uniform vec2 lip_edge;    // [m] along sight_up
uniform vec4 lip_shape;   // where it begins and is complete [m], breadth [m^2], gather [m]
// LipRetraction::held_aside() of common/model computes the same.
vec3 held_aside(vec3 p) {
    vec3 q = (to_sight * vec4(p, 1.0)).xyz;
    float before = smoothstep(lip_shape.x, lip_shape.y, q.z) * exp(-q.x * q.x / lip_shape.z);
    float split = 0.5 * (lip_edge.x + lip_edge.y);
    float upper = q.y < split ? smoothstep(lip_edge.x - lip_shape.w, lip_edge.x, q.y) : 0.0;
    float lower = q.y < split ? 0.0 : 1.0 - smoothstep(lip_edge.y, lip_edge.y + lip_shape.w, q.y);
    return p + sight_up * before * (lip_shift.y * lower - lip_shift.x * upper);
}
#endif
invariant gl_Position;
void main() {
    vec4 p = model * vec4(position, 1.0);
#ifdef RETRACT
    p.xyz = held_aside(p.xyz);
#endif
    world = p.xyz;
    normal_at = mat3(model) * normal;
#ifdef TUBE
    course_at = course;
#else
    colour_at = vec4(pow(colour.rgb, vec3(2.2)), colour.a);
#endif
#ifdef SHADOW
    shadow_at = (shadow_matrix * p).xyz;
#endif
    gl_ClipDistance[0] = dot(clip_plane, p);
    gl_Position = view_projection * p;
}
)";

/// Goes before the lighting of a mesh.
inline constexpr std::string_view mesh_inputs = R"(
in vec3 world;
in vec3 normal_at;
)";

/// Lights and the sum of what they give at `world`; colours are linear.
inline constexpr std::string_view lighting = R"(
out vec4 pixel;
uniform vec3 eye;
uniform vec3 ambient_high;
uniform vec3 ambient_low;
uniform vec3 light_position[2];
uniform vec3 light_direction[2];
uniform vec3 light_colour[2];
uniform vec3 light_shape[2];   // cosines of outer and inner cone, square of the reach [m^2]
#ifdef SHADOW
in vec3 shadow_at;
uniform sampler2DShadow shadow_map;
#endif

vec3 ambient(vec3 n) { return mix(ambient_low, ambient_high, 0.5 - 0.5 * n.y); }

// Filmic curve of Narkowicz 2015; keeps highlights from clipping to flat white.
vec3 tone(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }

struct Arriving { vec3 direction; vec3 colour; };

Arriving arriving(int i) {
    vec3 way = light_position[i] - world;
    float squared = dot(way, way);
    vec3 l = way * inversesqrt(squared);
    float strength = smoothstep(light_shape[i].x, light_shape[i].y, dot(-l, light_direction[i]));
    strength *= light_shape[i].z / (light_shape[i].z + squared);
#ifdef SHADOW
    if (i == 0) {
        strength *= 0.25 + 0.75 * texture(shadow_map, shadow_at);
    }
#endif
    return Arriving(l, light_colour[i] * strength);
}
)";

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
    pixel = vec4(tone(sum), 1.0);
}
)";

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
    pixel = vec4(tone(sum), opacity);
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
    pixel = vec4(tone(sum), opacity * clamp(cover + 0.5 * shine, 0.0, 1.0));
}
)";

/// One colour, not lit: object ids, and with no colour written depth and stencil.
inline constexpr std::string_view flat_fragment = R"(
out vec4 pixel;
uniform vec4 flat_colour;
void main() { pixel = flat_colour; }
)";

/// Cut faces of the section: a quad over the plane, or the band along the contour (BAND).
inline constexpr std::string_view cut_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 colour;
uniform mat4 view_projection;
out vec3 world;
out vec3 colour_at;
void main() {
    world = position;
    colour_at = pow(colour.rgb, vec3(2.2));
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

/// A quad over the viewport that darkens towards the edge like the sight through a narrow opening.
inline constexpr std::string_view vignette_vertex = R"(
out vec2 corner;
uniform float aspect;
void main() {
    vec2 c = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    corner = c * vec2(aspect, 1.0);
    gl_Position = vec4(c, 0.0, 1.0);
}
)";
inline constexpr std::string_view vignette_fragment = R"(
in vec2 corner;
out vec4 pixel;
void main() {
    float light = 1.0 - smoothstep(0.75, 1.45, length(corner));
    pixel = vec4(vec3(0.08 + 0.92 * light), 1.0);
}
)";

}  // namespace eti::render::source
