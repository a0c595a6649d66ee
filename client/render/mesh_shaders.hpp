// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

#include "client/render/finer_shaders.hpp"
#include "client/render/light_shaders.hpp"

namespace eti::render::source {

/// All meshes. Defines: FINER (of a patient, see finer_vertex), TUBE (course in place of colour), TISSUE
/// (with relief and rest position), FILM (of liquid, with TISSUE), ROOM_SHADOW and LAMP_SHADOW (also look
/// into that light's shadow map), RETRACT (lips held aside, see LipRetraction); FROM_LAMP: into the lamp's
/// shadow map. LIT_AT_VERTICES: calls light_vertex(), which goes after it.
inline const std::string mesh_vertex =
    std::string(lamp_map) + "#ifdef FINER\n" + std::string(finer_vertex) + R"(
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
out vec2 course_at;
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
#ifdef ROOM_SHADOW
uniform mat4 room_lookup;
out vec3 room_at;
#endif
#ifdef LAMP_SHADOW
out vec3 lamp_at;
#endif
#ifdef RETRACT
uniform mat4 to_sight;
uniform vec3 sight_up;
uniform vec2 lip_shift;   // upper lip downwards, lower lip upwards [m]
uniform vec2 lip_edge;    // [m] along sight_up
uniform vec4 lip_shape;   // where it begins and is complete [m], breadth [m^2], gather [m]
// LipRetraction::held_aside() of common/model computes the same.
vec3 held_aside(vec3 p) {
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
    vec3 held = held_aside(p.xyz);
    if (held != p.xyz) {
        // The normal turns with what lies about it.
        const float apart = 0.2e-3;
        vec3 aside = normalize(cross(normal_at, abs(normal_at.y) < 0.7 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
        vec3 along = normalize(cross(normal_at, aside));
        normal_at = cross(held_aside(p.xyz + apart * aside) - held, held_aside(p.xyz + apart * along) - held) / (apart * apart);
        p.xyz = held;
#ifdef FINER
        face_normal = normal_at;
#endif
    }
#endif
    world = p.xyz;
#ifdef TUBE
    course_at = course;
#else
    colour_at = vec4(colour.rgb * colour.rgb * (0.75 + 0.25 * colour.rgb), colour.a);
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
#if defined(ROOM_SHADOW) || defined(LAMP_SHADOW)
    vec4 casts = p;
#ifdef FINER
    casts.xyz -= bend;   // shadows are thrown by the flat triangle
#endif
#endif
#ifdef ROOM_SHADOW
    room_at = (room_lookup * casts).xyz;
#endif
#ifdef LAMP_SHADOW
    lamp_at = lamp_texel(casts.xyz);
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
)";

/// Goes before the lighting of a mesh.
inline constexpr std::string_view mesh_inputs = R"(
in vec3 world;
in vec3 normal_at;
)";

/// One colour, not lit: object ids, BOTH_SIDES with another for back faces, BY_TISSUE that of
/// each vertex's tissue; with no colour written depth and
/// stencil.
inline constexpr std::string_view flat_fragment = R"(
out vec4 pixel;
uniform vec4 flat_colour;
#ifdef BOTH_SIDES
uniform vec4 back_colour;
void main() { pixel = gl_FrontFacing ? flat_colour : back_colour; }
#elif defined(BY_TISSUE)
flat in float label_at;
void main() { pixel = vec4(label_at, 0.0, 0.0, 1.0); }
#else
void main() { pixel = flat_colour; }
#endif
)";

}  // namespace eti::render::source
