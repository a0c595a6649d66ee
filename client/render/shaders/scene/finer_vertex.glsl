// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Replaces a patient's vertex attributes by a point on a tessellated triangle, see TessellatedFace.
// The grid's points are the vertices, the triangles the instances. Include before any use of the
// attributes. steps_of(), barycentric_at() and curved_vertex() of
// client/render/mesh/outline_tessellation.hpp compute the same. Defines: TISSUE, FILM.
layout(location = 0) in ivec2 step;
layout(location = 1) in uint face;   // triangle and steps, see pack()
uniform int grid;
uniform float max_bend;
uniform usamplerBuffer triangles;
uniform samplerBuffer skinned;    // position and normal, two components per texel
uniform samplerBuffer colours, reliefs, rests, films;
vec3 position, normal, rest;
vec4 colour, relief;
float film;
vec3 bend;                        // of position from the flat triangle
vec3 flat_normal;                 // of the flat triangle, of any length
vec3 place_of(samplerBuffer from, int vertex) {
    return vec3(texelFetch(from, 3 * vertex).rg, texelFetch(from, 3 * vertex + 1).r);
}
vec3 on_edge(int along, int edge) {
    int code = int(face >> (20 + 4 * edge)) & 15;
    int count = code < 4 ? code + 1 : ((code & 3) + 5) << ((code >> 2) - 1);
    int at = (2 * along * count + grid) / (2 * grid);
    return vec3(float(count - at) / float(count), float(at) / float(count), 0.0);
}
vec3 shares() {
    if (step.y == 0) {
        return on_edge(step.x, 0);
    }
    if (step.x + step.y == grid) {
        return on_edge(step.y, 1).zxy;
    }
    if (step.x == 0) {
        return on_edge(step.y, 2).xzy;
    }
    return vec3(float(grid - step.x - step.y) / float(grid), float(step.x) / float(grid), float(step.y) / float(grid));
}
void finer_vertex() {
    vec3 share = shares();
    int triangle = int(face & 0xfffffu);
    ivec3 at;
    for (int k = 0; k < 3; ++k) {
        at[k] = int(texelFetch(triangles, 3 * triangle + k).r);
    }
    bool turned = (at.x > at.y) ^^ (at.y > at.z) ^^ (at.x > at.z);
    // Ascending, so that neighbours compute a shared edge identically.
    at.xy = ivec2(min(at.x, at.y), max(at.x, at.y));
    at.yz = ivec2(min(at.y, at.z), max(at.y, at.z));
    at.xy = ivec2(min(at.x, at.y), max(at.x, at.y));
    vec3 p[3], n[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = place_of(skinned, at[k]);
        n[k] = vec3(texelFetch(skinned, 3 * at[k] + 1).g, texelFetch(skinned, 3 * at[k] + 2).rg);
    }
    flat_normal = (turned ? -1.0 : 1.0) * cross(p[1] - p[0], p[2] - p[0]);
    vec3 flat_place = share.x * p[0] + share.y * p[1] + share.z * p[2];
    bend = vec3(0.0);
    for (int k = 0; k < 3; ++k) {
        bend += share[k] * (n[k] * dot(flat_place - p[k], n[k]));
    }
    bend *= -0.5;
    bend *= min(1.0, max_bend / max(length(bend), 1e-12));
    position = flat_place + bend;
    normal = share.x * n[0] + share.y * n[1] + share.z * n[2];
    normal /= max(length(normal), 1e-10);
    colour = share.x * texelFetch(colours, at.x) + share.y * texelFetch(colours, at.y) + share.z * texelFetch(colours, at.z);
#ifdef TISSUE
    relief = share.x * texelFetch(reliefs, at.x) + share.y * texelFetch(reliefs, at.y) + share.z * texelFetch(reliefs, at.z);
    rest = share.x * place_of(rests, at.x) + share.y * place_of(rests, at.y) + share.z * place_of(rests, at.z);
#endif
#ifdef FILM
    film = share.x * texelFetch(films, at.x).r + share.y * texelFetch(films, at.y).r + share.z * texelFetch(films, at.z).r;
#endif
}
