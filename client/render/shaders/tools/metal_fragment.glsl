// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Steel, brushed along the blade and around the handle: reflects the environment, or else bright panels over dark
// surroundings. Defines: LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS, ENVIRONMENT, DETAILS (in fine pictures, the knurl
// of a handle where the gloss is low).
#include "scene/mesh_inputs.glsl"
#include "scene/lighting.glsl"
in vec4 colour_at;
uniform float opacity;
uniform mat4 model;
float lattice(float x) { return fract(sin(x * 12.9898) * 43758.5453); }
#ifdef ENVIRONMENT
vec3 room(vec3 r) { return 1.7 * mirrored(r, 0.22); }
#else
// The reflected room: the light's panel, the ceiling, a dark band at the horizon, the table.
vec3 room(vec3 r) {
    float up = -r.y;
    vec3 seen = mix(1.6 * ambient_low + 0.05 * light_colour[0], 2.6 * ambient_high, smoothstep(-0.25, 0.7, up));
    seen *= 1.0 - 0.45 * exp(-30.0 * up * up);
    float panel = dot(r, normalize(light_position[0] - world));
    return seen + light_colour[0] * (0.80 * smoothstep(0.80, 0.95, panel) + 0.22 * smoothstep(-0.1, 0.9, panel));
}
#endif
void main() {
    vec3 v = normalize(eye - world);
    vec3 n = normalize(normal_at);
    vec3 local = (world - model[3].xyz) * mat3(model);  // [m], tool frame
    bool on_handle = local.y > 0.009;
    // Streaks half a millimetre wide tilt the normal a little across the brushing.
    vec3 along = normalize(on_handle ? cross(model[1].xyz, n) + 1e-4 * model[2].xyz : model[2].xyz);
    vec3 side = cross(n, along);
    float across = (on_handle ? local.y : local.x) * 2000.0;
    float streak = mix(lattice(floor(across)), lattice(floor(across) + 1.0), smoothstep(0.0, 1.0, fract(across)));
    n = normalize(n + 0.05 * (streak - 0.5) * side);
    vec3 steel = colour_at.rgb * (0.86 + 0.10 * streak);
#ifdef DETAILS
    // Diamonds of 0.9 mm, which fade where a pixel covers them.
    const float pitch = 0.9e-3, grip_radius = 9.2e-3;
    float girth = atan(local.z, local.x) * grip_radius;
    vec2 diagonals = 6.28318531 / pitch * vec2(girth + local.y, girth - local.y);
    float knurl = (1.0 - smoothstep(0.5, 0.9, colour_at.a)) * clamp(1.2 - 1.5 * fwidth(local.y) / pitch, 0.0, 1.0);
    vec2 tilt = 0.45 * knurl * sin(diagonals);
    n = normalize(n + tilt.x * (along - side) + tilt.y * (along + side));
    steel *= 1.0 - 0.22 * knurl * (1.0 - 0.5 * (cos(diagonals.x) + cos(diagonals.y)));
#endif
    float facing = clamp(dot(n, v), 0.0, 1.0);
    float grazing = (1.0 - facing) * (1.0 - facing);
    vec3 sum = mix(steel, vec3(1.0), grazing * grazing * (1.0 - facing)) * room(reflect(-v, n));
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = arriving(i);
        float nl = max(dot(n, light.direction), 0.0);
        vec3 h = normalize(light.direction + v);
        // Anisotropic Trowbridge-Reitz: brushing spreads a highlight across itself (Burley 2012).
        float th = dot(along, h), bh = dot(side, h), nh = dot(n, h);
        float t = th * th / 0.02 + bh * bh / 0.09 + nh * nh;
        sum += light.colour * steel * nl * (0.10 + 2.0 / (t * t));
    }
    pixel = vec4(min(sum, brightest), opacity);
}
