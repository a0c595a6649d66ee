// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Polished steel, brushed lengthwise: mirrors a room of bright panels over dark surroundings.
inline constexpr std::string_view metal_fragment = R"(
in vec4 colour_at;
uniform float opacity;
uniform mat4 model;
float lattice(float x) { return fract(sin(x * 12.9898) * 43758.5453); }
// What the room looks like in a mirror: the light's panel, the ceiling, a dark band at the horizon, the table.
vec3 room(vec3 r) {
    float up = -r.y;
    vec3 seen = mix(1.6 * ambient_low + 0.05 * light_colour[0], 2.6 * ambient_high, smoothstep(-0.25, 0.7, up));
    seen *= 1.0 - 0.45 * exp(-30.0 * up * up);
    float panel = dot(r, normalize(light_position[0] - world));
    return seen + light_colour[0] * (0.80 * smoothstep(0.80, 0.95, panel) + 0.22 * smoothstep(-0.1, 0.9, panel));
}
void main() {
    vec3 v = normalize(eye - world);
    vec3 n = normalize(normal_at);
    // Streaks half a millimetre wide across the tool tilt the mirror a little.
    vec3 side = normalize(model[0].xyz);
    float across = dot(side, world - model[3].xyz) * 2000.0;
    float streak = mix(lattice(floor(across)), lattice(floor(across) + 1.0), smoothstep(0.0, 1.0, fract(across)));
    n = normalize(n + 0.05 * (streak - 0.5) * side);
    vec3 steel = colour_at.rgb * (0.86 + 0.10 * streak);
    float facing = clamp(dot(n, v), 0.0, 1.0);
    float grazing = (1.0 - facing) * (1.0 - facing);
    vec3 sum = mix(steel, vec3(1.0), grazing * grazing * (1.0 - facing)) * room(reflect(-v, n));
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving(i);
        float nl = max(dot(n, light.direction), 0.0);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float t = nh * nh * (0.03 - 1.0) + 1.0;
        sum += light.colour * steel * nl * (0.10 + 0.0024 / (t * t));
    }
    pixel = vec4(min(sum, brightest), opacity);
}
)";

/// A cotton cloth over a table, level and lit at its vertices; goes after `lights`. The lamp's light ends
/// before it. Defines: ROOM_SHADOW.
inline constexpr std::string_view cloth_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 colour;
uniform mat4 view_projection;
uniform vec4 clip_plane;
out vec3 world;
out vec3 in_shade;    // what it looks like there
out vec3 from_room;   // what light 0 adds
#ifdef ROOM_SHADOW
uniform mat4 room_lookup;
out vec3 room_at;
#endif
void main() {
    const vec3 n = vec3(0.0, -1.0, 0.0);
    world = position;
    vec3 albedo = colour.rgb * colour.rgb * (0.75 + 0.25 * colour.rgb);
    albedo *= exp(-2.0 * max(length(position.xz) - 0.25, 0.0));
    // Beneath a head little of the room's light arrives.
    albedo *= 0.62 + 0.38 * smoothstep(0.02, 0.10, length(position.xz - vec2(0.0, 0.02)));
    Arriving light = unhindered(0, position);
    in_shade = albedo * ambient(n);
    from_room = albedo * light.colour * max(dot(n, light.direction), 0.0);
#ifdef ROOM_SHADOW
    room_at = (room_lookup * vec4(position, 1.0)).xyz;
#endif
    gl_ClipDistance[0] = dot(clip_plane, vec4(position, 1.0));
    gl_Position = view_projection * vec4(position, 1.0);
}
)";

/// FINE: with its weave.
inline constexpr std::string_view cloth_fragment = R"(
in vec3 in_shade;
in vec3 from_room;
void main() {
    vec3 sum = in_shade;
#ifdef ROOM_SHADOW
    sum += unshadowed(room_depth, room_at) * from_room;
#else
    sum += from_room;
#endif
#ifdef FINE
    // Far off the weave is finer than a pixel.
    float weave = 0.25 * (sin(world.x * 2200.0) + sin(world.z * 2200.0));
    sum *= 0.97 + 0.06 * weave * (1.0 - smoothstep(0.3, 0.7, length(eye - world)));
#endif
    pixel = vec4(min(sum, brightest), 1.0);
}
)";

/// Clear plastic with a radio-opaque line, a numbered mark every centimetre from the tip, the black band that
/// is to lie at the cords, and the connector behind the tube's end. REFRACT: near wall, through which one
/// sees what was drawn before, far wall included, bent where the wall curves away and tinted by the way
/// through it. FAR: only what is printed on the far wall.
inline constexpr std::string_view tube_fragment = R"(
in vec2 course_at;
uniform float tube_length;
uniform float opacity;
#ifdef REFRACT
uniform sampler2D behind;       // the picture so far
uniform vec4 behind_area;       // of it: first and last pixel
uniform mat4 view;
uniform vec3 wall;              // outer radius [m], inner over outer, pixels across a metre at one metre
#endif
// Digits of three by five points, the first row's left one in the highest bit.
const int font[10] = int[10](31599, 11415, 29671, 29647, 23497, 31183, 31215, 29257, 31727, 31695);
float glyph(int digit, vec2 p) {
    ivec2 at = ivec2(floor(p * vec2(3.0, 5.0)));
    bool inside = all(greaterThanEqual(at, ivec2(0))) && at.x < 3 && at.y < 5;
    return inside && (font[digit] >> (14 - 3 * at.y - at.x) & 1) == 1 ? 1.0 : 0.0;
}
// How much ink lies there: rgb its colour.
vec4 printed() {
    float centimetres = course_at.x * 100.0;
    float from_mark = abs(fract(centimetres + 0.5) - 0.5) / 100.0;
    float turn = abs(fract(course_at.y + 0.5) - 0.5);
    float line = 1.0 - smoothstep(0.030, 0.045, turn);
    float mark = (1.0 - smoothstep(0.00025, 0.0005, from_mark)) * step(0.5, centimetres) * step(turn, 0.27);
    float band = smoothstep(0.0205, 0.021, course_at.x) * (1.0 - smoothstep(0.0225, 0.023, course_at.x));
    // Just past each mark, read with the tip to the left: so many millimetres along, and a part of the turn.
    int number = int(floor(centimetres));
    float along = (fract(centimetres) - 0.08) / 0.11;
    float down = (fract(course_at.y) - 0.08) / 0.15;
    float digits = number < 10 ? glyph(number, vec2(along, down))
                               : max(glyph(number / 10, vec2(along, down)),
                                     glyph(number % 10, vec2(along - 1.35, down)));
    digits *= step(1.0, centimetres) * step(course_at.x, tube_length);
    float ink = max(max(max(mark, digits), 0.85 * line), band);
    return vec4(mix(vec3(0.03, 0.10, 0.35), vec3(0.01, 0.012, 0.02), band), ink);
}
void main() {
    vec3 n = normalize(normal_at);
    vec3 v = normalize(eye - world);
    float facing = abs(dot(n, v));
    float rim = 1.0 - facing;
    vec4 ink = printed();
    float hub = step(tube_length, course_at.x);
    vec3 albedo = mix(mix(vec3(0.62, 0.76, 0.86), ink.rgb, ink.a), vec3(0.10, 0.28, 0.62), hub);
    float cover = max(0.42 + 0.45 * rim * rim, max(0.92 * ink.a, hub));
#ifdef FAR
    cover = max(0.85 * ink.a, hub);
#endif
#ifdef REFRACT
    // Clear but for a little haze, which the way through the wall gathers.
    float aside = sqrt(max(1.0 - facing * facing, 0.0));
    float chord = 2.0 * (facing - sqrt(max(wall.y * wall.y - aside * aside, 0.0))) * wall.x * 1000.0;
    vec3 through = exp(-vec3(0.075, 0.052, 0.040) * chord);
    cover = max(1.0 - exp(-0.10 * chord), max(0.92 * ink.a, hub));
#endif
    vec3 sum = albedo * ambient(n);
    float shine = 0.0;
    for (int i = 0; i < 2; ++i) {
        Arriving light = arriving(i);
        float nl = 0.5 + 0.5 * dot(n, light.direction);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh4 = nh * nh * nh * nh;
        float nh16 = nh4 * nh4 * nh4 * nh4;
        float gloss = nh16 * nh16 * nh16 * nh16;
        sum += min(light.colour, vec3(1.5)) * (albedo * nl * nl + 0.9 * gloss);
        shine += gloss;
    }
#ifdef REFRACT
    // A hollow tube is no lens in its middle; towards the rim its walls bend what lies behind outward.
    vec2 bent = (mat3(view) * n).xy * aside * aside * 0.55 * wall.x * wall.z / max(length(eye - world), 1e-3);
    vec2 at = clamp(gl_FragCoord.xy + bent, behind_area.xy, behind_area.zw);
    vec3 seen = texelFetch(behind, ivec2(at), 0).rgb * through;
    // PVC's index of 1.54 mirrors 4.5 % of what comes straight (Schlick 1994).
    float fresnel = 0.045 + 0.955 * rim * rim * rim * rim * rim;
    sum = mix(mix(seen, sum, cover), 1.2 * ambient(reflect(-v, n)), 0.8 * fresnel * (1.0 - hub));
    for (int i = 0; i < 2; ++i) {
        Arriving light = arriving(i);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        sum += 0.6 * light.colour * pow(nh, 220.0);
    }
    pixel = vec4(min(sum, brightest), 1.0);
#elif defined(FAR)
    pixel = vec4(min(sum, brightest), cover);
#else
    pixel = vec4(min(sum, brightest), opacity * clamp(cover + 0.5 * shine, 0.0, 1.0));
#endif
}
)";

}  // namespace eti::render::source
