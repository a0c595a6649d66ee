// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Hair on a newborn's skin: scalp, brows, lanugo and lashes, drawn into the albedo by place on the rest shape; include
// after `blood` and detail_at(). Newborn places as NewbornSkin::to_model(). Draws nothing. Defines: none.
uniform sampler2D hairs;         // HairPattern
uniform vec2 hair_tile;          // its size across and along [mm]
uniform float newborn_size;      // relative to 3.5 kg
uniform float prematurity;       // 0-1
// A coordinate of polar angle, continuous where the angle wraps.
float turn_of(vec2 p, out float slope) {
    float a = atan(p.y, p.x) / 6.28318531, b = fract(a + 0.75) - 0.75;
    float wa = fwidth(a), wb = fwidth(b);
    slope = min(wa, wb);
    return wa <= wb ? a : b;
}
vec2 strands(float u, float v, vec2 dx, vec2 dy) { return textureGrad(hairs, vec2(u, v), dx, dy).rg; }
// Veins that thin skin shows: the mucosa's vessels, enlarged, with the blue that tissue above them leaves.
void show_veins(vec3 rest, vec3 n, float mucosa_share, inout vec3 albedo) {
    float vein, mottling;
    vec3 slope;
    detail_at(rest / 7.0 + 0.031, n, vein, slope, mottling);
    float thin = (1.0 - mucosa_share) * smoothstep(0.3, 0.6, blood_in(albedo));
    albedo *= mix(vec3(1.0), vec3(0.66, 0.80, 0.98), mix(0.12, 0.75, prematurity) * thin * smoothstep(0.05, 0.6, vein));
}
void grow_hair(vec3 rest, float hair, inout vec3 albedo, inout float wet) {
    vec3 q = vec3(rest.x, -rest.y, rest.z) / (1e-3 * newborn_size) + vec3(0.0, 45.5, -6.9);
    float side = abs(q.x);
    // Hair radiates from the whorl, left of the midline at the back of the vertex.
    const vec3 whorl = vec3(9.0, -48.0, 78.0), axis = vec3(0.0, -0.55, 0.835);
    const vec3 across = vec3(1.0, 0.0, 0.0), ahead = vec3(0.0, 0.835, 0.55);
    vec3 off = q - whorl;
    float along = length(off);
    vec2 plane = vec2(dot(off, across), dot(off, ahead));
    float around = max(length(plane), 1.0);
    float slope;
    float turn = turn_of(plane, slope) + 0.12 * log2(1.0 + along / 6.0);
    // Powers of two of tiles fit around; neighbours fade into each other.
    float octave = log2(6.28318531 * around / hair_tile.x);
    float count = exp2(floor(octave)), later = fract(octave);
    float v = along / hair_tile.y;
    // Brows: strands lie outwards, rising towards the temple.
    float ridge = (side - 18.0) / 11.0;
    bool brow = q.y > 20.0 && side < 30.0 && abs(q.z - 35.0 + 2.2 * ridge * ridge) < 3.2;
    vec2 at_brow = vec2((q.z - 0.25 * side) / hair_tile.x, side / hair_tile.y);
    vec2 place = brow ? at_brow : vec2(turn * count, v);
    vec2 second = brow ? at_brow : vec2(turn * count * 2.0 + 0.37, v + 0.41);
    float width = brow ? fwidth(q.z) / hair_tile.x : slope * count;
    vec2 dx = vec2(width, 0.0), dy = vec2(0.0, fwidth(along) / hair_tile.y);
    vec2 strand = mix(strands(place.x, place.y, dx, dy), strands(second.x, second.y, 2.0 * dx, dy),
                      brow ? 0.0 : smoothstep(0.3, 0.7, later));
    float cover = clamp(3.0 * (strand.r - (1.0 - hair)) * step(0.01, hair), 0.0, 1.0);
    float down = max(smoothstep(0.42, 0.25, hair), brow ? 0.35 : 0.0);   // lanugo is pale
    vec3 colour = mix(vec3(0.075, 0.046, 0.030), vec3(0.42, 0.27, 0.20), down) * (0.3 + 1.5 * strand.g);
    albedo = mix(albedo, colour, cover * mix(0.78, 0.24, down));
    wet = mix(wet, 0.2, cover);
    // The line between the lids, and lashes below it, which fused lids lack.
    float bend = (side - 19.2) / 9.3;
    float below = 24.3 + 1.3 * bend * bend - q.z;
    float eye = step(28.0, q.y) * (1.0 - smoothstep(0.88, 1.06, abs(bend)));
    float line = eye * exp(-below * below / 0.16);
    albedo *= mix(vec3(1.0), vec3(0.40, 0.27, 0.26), mix(0.85, 0.45, prematurity) * line);
    float comb = (side - 0.55 * bend * max(below, 0.0)) / 0.62;
    float id = fract(sin(floor(comb) * 12.9898) * 43758.5453);
    float middle = abs(fract(comb) - 0.3 - 0.4 * id), pixel = fwidth(comb);
    float reach = (1.9 + 1.2 * id) * (1.0 - 0.35 * bend * bend);
    float hairline = 0.16 * (1.0 - below / reach);
    float lash = eye * (1.0 - prematurity) * step(-0.1, below) * step(below, reach) *
                 clamp((hairline - middle) / max(pixel, 0.05) + 0.5, 0.0, 1.0);
    albedo = mix(albedo, vec3(0.05, 0.032, 0.024), 0.75 * lash);
}
