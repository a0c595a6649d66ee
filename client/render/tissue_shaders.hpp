// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// What tissue throws back: light that is wrapped round by channel stands for scattering beneath the surface
/// (red travels farthest), under a clear wet coat (Trowbridge-Reitz; visibility after Kelemen & Szirmay-Kalos
/// 2001).
inline constexpr std::string_view tissue_light = R"(
struct Surface {
    vec3 albedo;
    vec3 n, coat;    // normals of the tissue and of the coat
    float wet, film; // shares of a whole coat, of a whole film of liquid
    float open;      // share of the room's light that comes so deep
};
float distribution(float nh, float roughness) {
    float squared = roughness * roughness;
    float t = nh * nh * (squared - 1.0) + 1.0;
    return squared / (3.14159 * t * t);
}
vec3 thrown_back(Surface s, vec3 v, vec3 l) {
    const vec3 wrap = vec3(0.30, 0.13, 0.09);
    float nl = dot(s.n, l);
    vec3 diffuse = max((nl + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
    vec3 h = normalize(l + v);
    float nh = clamp(dot(s.coat, h), 0.0, 1.0), lh = clamp(dot(l, h), 0.0, 1.0);
    float grazing = 1.0 - lh;
    float fresnel = 0.028 + 0.972 * grazing * grazing * grazing * grazing * grazing;
    float lobes = s.wet * (1.0 + 0.5 * s.film) * distribution(nh, mix(0.11, 0.07, s.film)) + 0.35 * distribution(nh, 0.38);
    float shine = fresnel * lobes / (4.0 * max(lh * lh, 0.1)) * clamp(dot(s.coat, l), 0.0, 1.0);
    return s.albedo * diffuse + shine * step(0.0, nl);
}
// From all sides, and what the coat mirrors at its rim.
vec3 without_lights(Surface s, vec3 v) {
    float rim = 1.0 - clamp(dot(s.coat, v), 0.0, 1.0);
    return s.open * (s.albedo * ambient(s.n) + (0.03 + 0.12 * s.wet) * rim * rim * rim * ambient(reflect(-v, s.coat)));
}
// What comes from lit walls about: in a throat no shadow of the lamp's is black.
vec3 from_walls(Surface s, vec3 lamp) { return 0.1 * s.albedo * s.albedo * lamp; }
float openness(float sky) { return mix(1.0, mix(0.06, 1.0, sky), occlusion); }
void wet_by(float film, vec3 stain, inout Surface s) {
    s.wet = max(s.wet, film);
    s.film = film;
    s.albedo *= mix(vec3(1.0), stain, film);
}
)";

/// Lights at the vertices what is seen from so far that few pixels lie between them: goes after `lights`,
/// `tissue_light` and mesh_vertex. Defines: those of mesh_vertex, LIGHTS.
inline constexpr std::string_view tissue_lit_vertex = R"(
uniform vec3 eye;
#ifdef FILM
uniform vec3 film_stain;
#endif
out vec3 unshaded;    // what arrives whatever lies in the way
#ifdef ROOM_SHADOW
out vec3 from_room;
#endif
#ifdef LAMP_SHADOW
out vec3 from_lamp;
#endif
void light_vertex() {
    vec3 v = normalize(eye - world), n = normalize(normal_at);
    Surface s = Surface(colour_at.rgb, n, n, colour_at.a, 0.0, openness(relief_at.x));
#ifdef FILM
    wet_by(film, film_stain, s);
#endif
    unshaded = without_lights(s, v);
    Arriving room = unhindered(0, world);
    vec3 lit = room.colour * thrown_back(s, v, room.direction);
#ifdef ROOM_SHADOW
    from_room = lit;
#else
    unshaded += s.open * lit;
#endif
#if LIGHTS > 1
    Arriving lamp = unhindered(1, world);
    unshaded += from_walls(s, lamp.colour);
    lit = lamp.colour * thrown_back(s, v, lamp.direction);
#ifdef LAMP_SHADOW
    from_lamp = lit;
#else
    unshaded += lit;
#endif
#endif
}
)";

/// What is left to each pixel then.
inline constexpr std::string_view tissue_lit_fragment = R"(
in vec3 unshaded;
#ifdef ROOM_SHADOW
in vec3 from_room;
#endif
#ifdef LAMP_SHADOW
in vec3 from_lamp;
#endif
void main() {
    vec3 sum = unshaded;
#ifdef ROOM_SHADOW
    sum += unshadowed(room_depth, room_at) * from_room;
#endif
#ifdef LAMP_SHADOW
    sum += unshadowed(lamp_depth, lamp_at) * from_lamp;
#endif
    pixel = vec4(min(sum, brightest), 1.0);
}
)";

/// Tissue, lit for each pixel; goes after `tissue_light`. Defines: FINER, as of mesh_vertex.
/// FINE: relief of the coat and small vessels, fixed to the rest shape. FILM: what liquid wetted is darker,
/// or stained, under a smoother coat.
inline constexpr std::string_view tissue_fragment = R"(
in vec4 colour_at;
in vec4 relief_at;   // share of the sky seen; share of mucosa
#ifdef FINER
flat in vec3 face_normal;
#endif
#ifdef FILM
in float film_at;    // share of a whole film
uniform vec3 film_stain;
#endif
#ifdef FINE
in vec3 rest_at;
float lattice(vec3 p) {   // Hoskins' hash without sine
    p = fract(p * 0.1031);
    p += dot(p, p.zyx + 31.32);
    return fract((p.x + p.y) * p.z);
}
// Smooth noise, 0-1, and its slope (Quilez 2017).
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
    // Where skinning has turned the normal away from the face that is seen, the face decides.
#ifdef FINER
    // The flat triangle's: small ones may lie across it, and are too thin for derivatives. Where that turns
    // its back, it is seen for being bent by the normal.
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
    // Swellings of 1.2 mm and pores of 0.4 mm; vessels of a tenth of a millimetre's breadth.
    vec4 swell = noise(rest_at * 850.0), pore = noise(rest_at * 2600.0);
    vec3 slope = 0.10 * swell.yzw + 0.07 * pore.yzw;
    s.coat = normalize(n - mix(0.6, 1.0, s.wet) * (1.0 - 0.6 * s.film) * (slope - dot(slope, n) * n));
    // Ridges of noise that thin out to nothing: contours of the same noise would close to rings.
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
)";

}  // namespace eti::render::source
