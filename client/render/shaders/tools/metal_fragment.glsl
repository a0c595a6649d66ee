// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Polished steel, brushed lengthwise: reflects the environment, or else bright panels over dark
// surroundings. Defines: LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS, ENVIRONMENT.
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
    // Streaks half a millimetre wide tilt the normal a little across the tool.
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
