// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The tube: clear plastic with a radio-opaque line, a numbered mark every centimetre from the tip on both sides of
// it, the size on the back, the black guide line that should lie at the cords, Murphy's eye on the right, and the
// connector behind the tube's end. Defines: REFRACT (near wall: refracts what was drawn before, including the far
// wall, and tints it by the path through the wall), FAR (only the print on the far wall), ROOM_SHADOW, LAMP_SHADOW,
// TAPS, LIGHTS.
#include "scene/mesh_inputs.glsl"
#include "scene/lighting.glsl"
in vec3 course_at;
uniform float tube_length;
uniform float circumference;    // [m]
uniform vec2 printed_size;      // inner diameter [mm]: whole and tenths
uniform vec3 murphy_eye;        // [m] from the tip to its centre; half length, half width
uniform sampler2D numerals;     // NumeralAtlas
uniform vec4 numeral_cell;      // left and lower margin, width and height, in heights of a numeral
uniform float opacity;
#ifdef REFRACT
uniform sampler2D behind;       // the picture so far
uniform vec4 behind_area;       // first and last pixel of the picture
uniform mat4 view;
uniform vec3 wall;              // outer radius [m], inner/outer radius, pixels per metre at one
                                // metre
#endif
// Ink colour (rgb) and coverage at a turn from the concave side, 0-1.
vec4 printed(float turn) {
    float from_line = min(turn, 1.0 - turn);
    // A pixel's size along and around [m].
    float pixel_size = max(fwidth(course_at.x), length(fwidth(course_at.yz)) * circumference / 6.28318531);
    float soft = max(0.125e-3, 0.6 * pixel_size);
    float line = 1.0 - smoothstep(0.030, 0.045, from_line);
    float centimetres = course_at.x * 100.0;
    float number = floor(centimetres);
    float from_mark = abs(fract(centimetres + 0.5) - 0.5) / 100.0;
    float mark = (1.0 - smoothstep(0.35e-3 - soft, 0.35e-3 + soft, from_mark)) * step(0.5, centimetres) * step(from_line, 0.27);
    float band = smoothstep(0.0205 - soft, 0.0205 + soft, course_at.x) * (1.0 - smoothstep(0.023 - soft, 0.023 + soft, course_at.x));
    // Numerals are readable with the tip to the left: those of the marks just past them, the size every 4 cm.
    bool back = abs(turn - 0.5) < 0.12;
    float height = back ? 0.20 : 0.15;          // of a numeral, in turns
    float advance = back ? 0.62 : 0.76;         // to the next one, in heights
    float down = (turn - (back ? 0.40 : turn < 0.5 ? 0.085 : 0.765)) / height;
    float along = (back ? mod(course_at.x, 0.04) - 0.012 : 0.01 * fract(centimetres) - 0.0011) / (height * circumference);
    float slot = floor(along / advance + 0.1);
    bool two = number >= 10.0;
    float glyph = back ? (slot < 0.5 ? printed_size.x : slot < 1.5 ? 10.0 : printed_size.y)
                       : (two && slot < 0.5 ? floor(number / 10.0) : mod(number, 10.0));
    vec2 at = (vec2(along - slot * advance, 1.0 - down) + numeral_cell.xy) / numeral_cell.zw;
    bool inside = at == clamp(at, 0.0, 1.0) && slot > -0.5 && slot < (back ? 2.5 : two ? 1.5 : 0.5);
    float blur = clamp(2.4 * pixel_size / (height * circumference), 0.03, 0.5);
    float digits = 0.0;
    if (inside && number > 0.5 && course_at.x < tube_length) {
        float within = textureLod(numerals, vec2((glyph + clamp(at.x, 0.01, 0.99)) / 11.0, at.y), 0.0).r;
        digits = smoothstep(0.5 - blur, 0.5 + blur, within) * (1.0 - band);
    }
    return vec4(mix(vec3(0.012, 0.014, 0.02), vec3(0.02, 0.09, 0.40), line * (1.0 - band)), max(max(max(mark, digits), 0.85 * line), band));
}
void main() {
    vec3 n = normalize(normal_at);
    vec3 v = normalize(eye - world);
    float facing = abs(dot(n, v));
    float rim = 1.0 - facing;
    float turn = fract(atan(course_at.z, course_at.y) / 6.28318531);
    float hub = step(tube_length + 0.2e-3, course_at.x);
    vec2 from_eye = vec2((course_at.x - murphy_eye.x) / murphy_eye.y, (turn - 0.75) * circumference / murphy_eye.z);
    float eye_edge = dot(from_eye, from_eye);
    if (eye_edge < 1.0) {
        discard;
    }
    // The cut wall around the eye, where the plastic is seen edge-on.
    float cut = 1.0 - smoothstep(1.25, 1.45, eye_edge);
    vec4 ink = printed(turn);
    vec3 albedo = mix(mix(vec3(0.62, 0.76, 0.86), ink.rgb, ink.a), vec3(0.10, 0.28, 0.62), hub);
    float haze = max(0.34 + 0.45 * rim * rim, 0.75 * cut);
    float cover = max(haze, max(0.92 * ink.a, hub));
#ifdef FAR
    cover = max(0.85 * ink.a, hub);
#endif
#ifdef REFRACT
    // Clear except for a slight haze that grows with the path through the wall.
    float aside = sqrt(max(1.0 - facing * facing, 0.0));
    float chord = 2.0 * (facing - sqrt(max(wall.y * wall.y - aside * aside, 0.0))) * wall.x * 1000.0;
    vec3 through = exp(-vec3(0.075, 0.052, 0.040) * chord);
    cover = max(max(1.0 - exp(-0.10 * chord), 0.6 * cut), max(0.92 * ink.a, hub));
#endif
#ifdef FAR
    if (cover < 0.004) {
        discard;    // nothing is printed here
    }
#endif
    vec3 sum = albedo * ambient(n), glint = vec3(0.0);
    float shine = 0.0;
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving(i);
        float nl = 0.5 + 0.5 * dot(n, light.direction);
        float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
        float nh4 = nh * nh * nh * nh;
        float nh16 = nh4 * nh4 * nh4 * nh4;
        float gloss = nh16 * nh16 * nh16 * nh16;
        sum += min(light.colour, vec3(1.5)) * (albedo * nl * nl + 0.9 * gloss);
        shine += gloss;
        glint += 0.6 * light.colour * gloss * gloss * gloss;
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
    sum += glint;
    pixel = vec4(min(sum, brightest), 1.0);
#elif defined(FAR)
    pixel = vec4(min(sum, brightest), cover);
#else
    pixel = vec4(min(sum, brightest), opacity * clamp(cover + 0.5 * shine, 0.0, 1.0));
#endif
}
