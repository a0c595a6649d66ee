// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Tissue with per-pixel lighting. Defines: FINER (as in mesh_vertex), FINE (relief of the wet coat
// and small vessels, fixed to the rest shape), FILM (wetted tissue is darker, or stained, under a
// smoother coat), LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS.
#include "scene/mesh_inputs.glsl"
#include "scene/lighting.glsl"
#include "tissue/tissue_light.glsl"
in vec4 colour_at;
in vec4 relief_at;   // sky visibility; share of mucosa
#ifdef FINER
flat in vec3 face_normal;
#endif
#ifdef FILM
in float film_at;    // fraction of a full film
uniform vec3 film_stain;
#endif
#ifdef FINE
in vec3 rest_at;
float lattice(vec3 p) {   // Hoskins' hash without sine
    p = fract(p * 0.1031);
    p += dot(p, p.zyx + 31.32);
    return fract((p.x + p.y) * p.z);
}
// Smooth noise, 0-1, and its gradient (Quilez 2017).
vec4 noise(vec3 x) {
    vec3 p = floor(x), w = fract(x);
    vec3 u = w * w * (3.0 - 2.0 * w), du = 6.0 * w * (1.0 - w);
    float a = lattice(p), b = lattice(p + vec3(1, 0, 0)), c = lattice(p + vec3(0, 1, 0)),
          d = lattice(p + vec3(1, 1, 0)), e = lattice(p + vec3(0, 0, 1)), f = lattice(p + vec3(1, 0, 1)),
          g = lattice(p + vec3(0, 1, 1)), h = lattice(p + vec3(1, 1, 1));
    float k1 = b - a, k2 = c - a, k3 = e - a, k4 = a - b - c + d, k5 = a - c - e + g, k6 = a - b - e + f,
          k7 = b + c + e - a - d - f - g + h;
    return vec4(a + k1 * u.x + k2 * u.y + k3 * u.z + k4 * u.x * u.y + k5 * u.y * u.z + k6 * u.z * u.x +
                    k7 * u.x * u.y * u.z,
                du * vec3(k1 + k4 * u.y + k6 * u.z + k7 * u.y * u.z, k2 + k5 * u.z + k4 * u.x + k7 * u.z * u.x,
                          k3 + k6 * u.x + k5 * u.y + k7 * u.x * u.y));
}
#endif
void main() {
    vec3 v = normalize(eye - world);
    vec3 n = normalize(normal_at);
    // Where skinning has turned the normal away from the visible face, the face normal takes over.
#ifdef FINER
    // The flat triangle's normal: small triangles may lie across it and are too thin for
    // derivatives. Where it faces away, the triangle is visible only because it is curved.
    vec3 face = face_normal * inversesqrt(max(dot(face_normal, face_normal), 1e-30));
    face = dot(face, v) < 0.0 ? n : face;
#else
    vec3 face = cross(dFdx(world), dFdy(world));
    face *= inversesqrt(max(dot(face, face), 1e-30)) * (dot(face, v) < 0.0 ? -1.0 : 1.0);
#endif
    n = normalize(mix(face, n, smoothstep(-0.1, 0.25, dot(n, face))));
    Surface s = Surface(colour_at.rgb, n, n, colour_at.a, 0.0, openness(relief_at.x));
#ifdef FILM
    wet_by(film_at, film_stain, s);
#endif
#ifdef FINE
    // Swellings of 1.2 mm and pores of 0.4 mm; vessels 0.1 mm wide.
    vec4 swell = noise(rest_at * 850.0), pore = noise(rest_at * 2600.0);
    vec3 slope = 0.10 * swell.yzw + 0.07 * pore.yzw;
    s.coat = normalize(n - mix(0.6, 1.0, s.wet) * (1.0 - 0.6 * s.film) * (slope - dot(slope, n) * n));
    // Ridges of noise that thin out: contour lines of the same noise would close to rings.
    vec3 bent = rest_at * 170.0 + 0.9 * noise(rest_at * 330.0 + 9.0).yzw + 0.3 * swell.x;
    float ridge = 1.0 - abs(2.0 * noise(bent).x - 1.0);
    float breadth = 0.085 * smoothstep(0.4, 0.8, noise(rest_at * 120.0 + 5.0).x);
    float vessel = smoothstep(0.0, 0.03, breadth + ridge - 1.0);
    s.albedo *= mix(vec3(1.0), vec3(0.80, 0.42, 0.42), 0.45 * relief_at.y * vessel);
    s.albedo *= 0.94 + 0.12 * swell.x;
#endif
    vec3 sum = without_lights(s, v);
    for (int i = 0; i < LIGHTS; ++i) {
        Arriving light = unhindered(i, world);
        sum += i == 1 ? from_walls(s, light.colour) : vec3(0.0);
        light.colour *= reaching(i);
#ifndef ROOM_SHADOW
        light.colour *= i == 0 ? s.open : 1.0;
#endif
        sum += light.colour * thrown_back(s, v, light.direction);
    }
    pixel = vec4(min(sum, brightest), 1.0);
}
