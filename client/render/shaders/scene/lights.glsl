// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The lights and their unshadowed contribution at a point; colours are linear. Defines: LIGHTS
// (number of lights, default 2; the second is the laryngoscope's lamp).
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

vec3 ambient(vec3 n) { return mix(ambient_low, ambient_high, 0.5 - 0.5 * n.y); }

struct Arriving { vec3 direction; vec3 colour; };

Arriving unhindered(int i, vec3 at) {
    vec3 way = light_position[i] - at;
    float squared = dot(way, way);
    vec3 l = way * inversesqrt(squared);
    float strength = smoothstep(light_shape[i].x, light_shape[i].y, dot(-l, light_direction[i]));
    return Arriving(l, light_colour[i] * (strength * light_shape[i].z / (light_shape[i].z + squared)));
}
