// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Reflectance of tissue: diffuse light wrapped per channel stands for subsurface scattering (red
// travels farthest), under a clear wet coat (Trowbridge-Reitz; visibility after Kelemen &
// Szirmay-Kalos 2001). Draws nothing. Defines: none.
struct Surface {
    vec3 albedo;
    vec3 n, coat;    // normals of the tissue and of the coat
    float wet, film; // fractions of a full coat, of a full film of liquid
    float open;      // fraction of the ambient light that reaches this depth
};
float distribution(float nh, float roughness) {
    float squared = roughness * roughness;
    float t = nh * nh * (squared - 1.0) + 1.0;
    return squared / (3.14159 * t * t);
}
vec3 thrown_back(Surface s, vec3 v, vec3 l) {
    const vec3 wrap = vec3(0.24, 0.13, 0.09);
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
// Ambient light, and its reflection by the coat at grazing angles.
vec3 without_lights(Surface s, vec3 v) {
    float rim = 1.0 - clamp(dot(s.coat, v), 0.0, 1.0);
    return s.open * (s.albedo * ambient(s.n) + (0.03 + 0.12 * s.wet) * rim * rim * rim * mirrored(reflect(-v, s.coat), 0.25));
}
// Indirect light from lit walls: in a throat the lamp's shadows are never black.
vec3 from_walls(Surface s, vec3 lamp) { return 0.1 * s.albedo * s.albedo * lamp; }
float openness(float sky) { return mix(1.0, mix(0.06, 1.0, sky), occlusion); }
void wet_by(float film, vec3 stain, inout Surface s) {
    s.wet = max(s.wet, film);
    s.film = film;
    s.albedo *= mix(vec3(1.0), stain, film);
}
