// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Vertex shader of all meshes. Defines:
// - FINER: tessellated patient, see finer_vertex
// - TUBE: course instead of colour
// - TISSUE: with relief and rest position
// - FILM: with liquid film; requires TISSUE
// - BY_TISSUE: tissue label, for flat_fragment
// - ROOM_SHADOW, LAMP_SHADOW: also compute coordinates in that light's shadow map
// - RETRACT: retracted lips, see LipRetraction
// - FROM_LAMP: draws into the lamp's shadow map
// - LIT_AT_VERTICES: calls light_vertex(), defined after this file
#include "scene/linear_colour.glsl"
#include "scene/shadow_places.glsl"
#ifdef FINER
#include "scene/finer_vertex.glsl"
#else
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
#ifdef TUBE
layout(location = 3) in vec2 course;
#else
layout(location = 2) in vec4 colour;
#endif
#if defined(TISSUE) || defined(BY_TISSUE)
layout(location = 4) in vec4 relief;
#endif
#ifdef TISSUE
layout(location = 5) in vec3 rest;
#endif
#ifdef FILM
layout(location = 6) in float film;
#endif
#endif
#ifdef TUBE
out vec3 course_at;     // [m] from the tip; cosine and sine of the turn, which has no seam
#else
out vec4 colour_at;
#endif
#ifdef TISSUE
out vec4 relief_at;
out vec3 rest_at;
#endif
#ifdef FILM
out float film_at;
#endif
#ifdef BY_TISSUE
flat out float label_at;
#endif
uniform mat4 model;
uniform mat4 view_projection;
uniform vec4 clip_plane;
out vec3 world;
out vec3 normal_at;
#ifdef FINER
flat out vec3 face_normal;   // of any length
#endif
#ifdef RETRACT
uniform mat4 to_sight;
uniform vec3 sight_up;
uniform vec2 lip_shift;   // displacement: upper lip downwards, lower lip upwards [m]
uniform vec2 lip_edge;    // [m] along sight_up
uniform vec4 lip_shape;   // start and end of the transition [m], breadth [m^2], gather [m]
// LipRetraction::retract_lips() of common/model computes the same.
vec3 retract_lips(vec3 p) {
    vec3 q = (to_sight * vec4(p, 1.0)).xyz;
    float before = smoothstep(lip_shape.x, lip_shape.y, q.z) * exp(-q.x * q.x / lip_shape.z);
    float middle = 0.5 * (lip_edge.x + lip_edge.y);
    float half_open = 0.5 * max(lip_edge.y - lip_edge.x, max(0.5 * (lip_shift.x + lip_shift.y), 1e-6));
    float lower = smoothstep(middle - half_open, middle + half_open, q.y);
    return p + sight_up * before *
                   (lower * lip_shift.y * (1.0 - smoothstep(lip_edge.y, lip_edge.y + lip_shape.w, q.y)) -
                    (1.0 - lower) * lip_shift.x * smoothstep(lip_edge.x - lip_shape.w, lip_edge.x, q.y));
}
#endif
#ifdef LIT_AT_VERTICES
void light_vertex();
#endif
invariant gl_Position;
void main() {
#ifdef FINER
    finer_vertex();
#endif
    vec4 p = model * vec4(position, 1.0);
    normal_at = mat3(model) * normal;
#ifdef FINER
    face_normal = mat3(model) * flat_normal;
#endif
#ifdef RETRACT
    vec3 held = retract_lips(p.xyz);
    if (held != p.xyz) {
        // The normal rotates with its surroundings.
        const float apart = 0.2e-3;
        vec3 aside = normalize(cross(normal_at, abs(normal_at.y) < 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
        vec3 along = normalize(cross(normal_at, aside));
        normal_at = cross(retract_lips(p.xyz + apart * aside) - held, retract_lips(p.xyz + apart * along) - held) / (apart * apart);
        p.xyz = held;
#ifdef FINER
        face_normal = normal_at;
#endif
    }
#endif
    world = p.xyz;
#ifdef TUBE
    course_at = vec3(course.x, cos(6.28318531 * course.y), sin(6.28318531 * course.y));
#else
    colour_at = vec4(linear(colour.rgb), colour.a);
#endif
#ifdef TISSUE
    relief_at = relief;
    rest_at = rest;
#endif
#ifdef FILM
    film_at = film;
#endif
#ifdef BY_TISSUE
    label_at = relief.z;
#endif
#ifdef FINER
    place_in_shadow_maps(p.xyz - bend);   // the flat triangle casts the shadows
#else
    place_in_shadow_maps(p.xyz);
#endif
#ifdef FROM_LAMP
    vec4 at = in_lamp_map(p.xyz);
    gl_ClipDistance[0] = at.w;
    gl_Position = vec4(at.xy, 2.0 * at.z - 1.0, 1.0);
#else
    gl_ClipDistance[0] = dot(clip_plane, p);
    gl_Position = view_projection * p;
#endif
#ifdef LIT_AT_VERTICES
    light_vertex();
#endif
}
