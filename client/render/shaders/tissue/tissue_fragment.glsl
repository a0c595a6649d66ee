// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Tissue with per-pixel lighting. Defines: FINER (as in mesh_vertex), FINE (relief of the wet coat
// and small vessels, fixed to the rest shape), FILM (wetted tissue is darker, or stained, under a
// smoother coat), HAIR (requires FINE), LIGHTS, ROOM_SHADOW, LAMP_SHADOW, TAPS.
#include "scene/mesh_inputs.glsl"
#include "scene/lighting.glsl"
#include "tissue/tissue_light.glsl"
#include "tissue/blood.glsl"
in vec4 colour_at;
in vec4 relief_at;   // VertexRelief
#ifdef FINER
flat in vec3 face_normal;
#endif
#ifdef FILM
in float film_at;    // fraction of a full film
uniform vec3 film_stain;
#endif
#ifdef FINE
in vec3 rest_at;
uniform sampler2D mucosa;      // MucosaPattern
uniform vec2 mucosa_scale;     // its period [m], steepest slope
// The pattern along each axis of the rest shape, by the share of the surface that faces that way.
void detail_at(vec3 p, vec3 n, out float blood, out vec3 slope, out float mottling) {
    vec3 facing = n * n;
    facing *= facing;
    facing /= facing.x + facing.y + facing.z;
    p /= mucosa_scale.x;
    vec4 a = texture(mucosa, p.yz), b = texture(mucosa, p.zx + 0.37), c = texture(mucosa, p.xy + 0.71);
    blood = dot(facing, vec3(a.r, b.r, c.r));
    mottling = dot(facing, vec3(a.a, b.a, c.a)) - 0.5;
    vec2 along_x = facing.x * (a.gb - 0.5), along_y = facing.y * (b.gb - 0.5), along_z = facing.z * (c.gb - 0.5);
    slope = 2.0 * mucosa_scale.y *
            vec3(along_y.y + along_z.x, along_x.x + along_z.y, along_x.y + along_y.x);
}
#endif
#ifdef HAIR
#include "tissue/hair.glsl"
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
    float blood, mottling;
    vec3 slope;
    detail_at(rest_at, n, blood, slope, mottling);
    slope -= dot(slope, n) * n;
    // The wet coat follows the relief, which a film of liquid levels; the tissue below scatters light and
    // shows less of it.
    s.coat = normalize(n - mix(0.6, 1.0, s.wet) * (1.0 - 0.6 * s.film) * slope);
    s.n = normalize(n - 0.25 * slope);
    s.albedo *= mix(vec3(1.0), vec3(0.74, 0.36, 0.38), 0.6 * relief_at.y * blood);
    s.albedo *= 1.0 + mottling * mix(vec3(0.12), vec3(0.10, 0.26, 0.24), relief_at.y);
#endif
    s.albedo = perfused(s.albedo, acral_of(relief_at.w));
#ifdef HAIR
    show_veins(rest_at, n, relief_at.y, s.albedo);
    grow_hair(rest_at, hair_of(relief_at.w), s.albedo, s.wet);
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
