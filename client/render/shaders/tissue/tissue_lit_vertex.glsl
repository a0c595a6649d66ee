// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Tissue with per-vertex lighting, for views so distant that only few pixels lie between vertices.
// Defines: those of mesh_vertex, LIGHTS.
#include "scene/lights.glsl"
#include "tissue/tissue_light.glsl"
#include "tissue/blood.glsl"
#include "scene/mesh_vertex.glsl"
uniform vec3 eye;
#ifdef FILM
uniform vec3 film_stain;
#endif
out vec3 unshaded;    // light that no shadow affects
#ifdef ROOM_SHADOW
out vec3 from_room;
#endif
#ifdef LAMP_SHADOW
out vec3 from_lamp;
#endif
void light_vertex() {
    vec3 v = normalize(eye - world), n = normalize(normal_at);
    Surface s = Surface(perfused(colour_at.rgb, acral_of(relief_at.w)), n, n, colour_at.a, 0.0, openness(relief_at.x));
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
