// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The lights and their unshadowed contribution at a point; colours are linear. Defines: LIGHTS
// (number of lights, default 2; the second is the laryngoscope's lamp), ENVIRONMENT (ambient light and
// reflections of the room, else two colours).
#ifndef LIGHTS
#define LIGHTS 2
#endif
uniform float occlusion;       // ambient light that cavities lose, 0-1
uniform vec3 ambient_high;
uniform vec3 ambient_low;
uniform vec3 light_position[2];
uniform vec3 light_direction[2];
uniform vec3 light_colour[2];
uniform vec3 light_shape[2];   // cosines of outer and inner cone, square of the reach [m^2]

#ifdef ENVIRONMENT
uniform vec3 irradiance[9];          // as in Irradiance, of unit gain
uniform float environment_gain;
uniform samplerCube environment_map; // roughness grows with the level
uniform float roughest_level;
vec3 ambient(vec3 n) {
    vec3 sum = irradiance[0] + irradiance[1] * n.x + irradiance[2] * n.y + irradiance[3] * n.z +
               irradiance[4] * (n.x * n.y) + irradiance[5] * (n.y * n.z) + irradiance[6] * (n.z * n.x) +
               irradiance[7] * (n.x * n.x - n.y * n.y) + irradiance[8] * (3.0 * n.z * n.z - 1.0);
    return environment_gain * max(sum, 0.0);
}
// The room as mirrored along r by a surface of this roughness.
vec3 mirrored(vec3 r, float roughness) {
    return environment_gain * textureLod(environment_map, r, roughness * roughest_level).rgb;
}
#else
vec3 ambient(vec3 n) { return mix(ambient_low, ambient_high, 0.5 - 0.5 * n.y); }
vec3 mirrored(vec3 r, float roughness) { return ambient(r); }
#endif

struct Arriving { vec3 direction; vec3 colour; };

Arriving unhindered(int i, vec3 at) {
    vec3 way = light_position[i] - at;
    float squared = dot(way, way);
    vec3 l = way * inversesqrt(squared);
    float strength = smoothstep(light_shape[i].x, light_shape[i].y, dot(-l, light_direction[i]));
    return Arriving(l, light_colour[i] * (strength * light_shape[i].z / (light_shape[i].z + squared)));
}
