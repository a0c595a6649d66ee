// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The tube: clear plastic with a radio-opaque line, a numbered mark every centimetre from the tip,
// the black band that should lie at the cords, and the connector behind the tube's end. Defines:
// REFRACT (near wall: refracts what was drawn before, including the far wall, and tints it by the
// path through the wall), FAR (only the print on the far wall), ROOM_SHADOW, LAMP_SHADOW, TAPS.
#include "scene/mesh_inputs.glsl"
#include "scene/lighting.glsl"
in vec2 course_at;
uniform float tube_length;
uniform float opacity;
#ifdef REFRACT
uniform sampler2D behind;       // the picture so far
uniform vec4 behind_area;       // first and last pixel of the picture
uniform mat4 view;
uniform vec3 wall;              // outer radius [m], inner/outer radius, pixels per metre at one
                                // metre
#endif
// Digits of 3 x 5 pixels, upper left in the highest bit.
const int font[10] = int[10](31599, 11415, 29671, 29647, 23497, 31183, 31215, 29257, 31727, 31695);
float glyph(int digit, vec2 p) {
    ivec2 at = ivec2(floor(p * vec2(3.0, 5.0)));
    bool inside = all(greaterThanEqual(at, ivec2(0))) && at.x < 3 && at.y < 5;
    return inside && (font[digit] >> (14 - 3 * at.y - at.x) & 1) == 1 ? 1.0 : 0.0;
}
// Ink colour (rgb) and coverage.
vec4 printed() {
    float centimetres = course_at.x * 100.0;
    float from_mark = abs(fract(centimetres + 0.5) - 0.5) / 100.0;
    float turn = abs(fract(course_at.y + 0.5) - 0.5);
    float line = 1.0 - smoothstep(0.030, 0.045, turn);
    float mark = (1.0 - smoothstep(0.00025, 0.0005, from_mark)) * step(0.5, centimetres) * step(turn, 0.27);
    float band = smoothstep(0.0205, 0.021, course_at.x) * (1.0 - smoothstep(0.0225, 0.023, course_at.x));
    // Number just past each mark, readable with the tip to the left: height in millimetres along
    // the tube, width as a fraction of a turn.
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
    // Clear except for a slight haze that grows with the path through the wall.
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
    // A hollow tube does not refract in its middle; towards the rim its walls deflect the
    // background outward.
    vec2 bent = (mat3(view) * n).xy * aside * aside * 0.55 * wall.x * wall.z / max(length(eye - world), 1e-3);
    vec2 at = clamp(gl_FragCoord.xy + bent, behind_area.xy, behind_area.zw);
    vec3 seen = texelFetch(behind, ivec2(at), 0).rgb * through;
    // PVC's refractive index of 1.54 reflects 4.5 % at normal incidence (Schlick 1994).
    float fresnel = 0.045 + 0.955 * rim * rim * rim * rim * rim;
    sum = mix(mix(seen, sum, cover), 1.2 * mirrored(reflect(-v, n), 0.15), 0.8 * fresnel * (1.0 - hub));
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
