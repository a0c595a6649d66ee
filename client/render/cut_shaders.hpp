// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

namespace eti::render::source {

/// Corners of a skinned surface's triangles, for cut_geometry.
inline constexpr std::string_view cut_surface_vertex = R"(
layout(location = 0) in vec3 position;
#ifndef FAN
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
out vec3 corner_normal;
out vec3 corner_colour;
#endif
uniform vec4 plane;       // dot(xyz, p) + w >= 0 stays
out vec4 corner;          // and its side of the plane
flat out int corner_index;
void main() {
    corner = vec4(position, dot(plane.xyz, position) + plane.w);
    corner_index = gl_VertexID;
#ifndef FAN
    corner_normal = normal;
    corner_colour = colour.rgb;
#endif
}
)";

/// Where the plane cuts a triangle it becomes a piece of the contour: with FAN the triangle from `pivot`, a
/// point of the plane, to that piece, whose ends follow each other with the inside at one hand: a place lies
/// inside where more of them turn one way than the other, also where a surface overlaps itself; else the band
/// of `width` inside the contour in the surface's own colour, with which skin, mucosa and cords keep theirs
/// along the cut.
inline constexpr std::string_view cut_geometry = R"(
layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;
in vec4 corner[];
flat in int corner_index[];
uniform vec4 plane;
uniform mat4 view_projection;
out vec3 world;
out vec3 colour_at;
void put(vec3 p, vec3 c) {
    world = p;
    colour_at = c * c * (0.75 + 0.25 * c);
    gl_Position = view_projection * vec4(p, 1.0);
    EmitVertex();
}
// From the same end in both triangles of the edge, so that their pieces meet in one point.
vec3 crossing(vec4 a, vec4 b, bool a_first) {
    vec4 low = a_first ? a : b, high = a_first ? b : a;
    return low.xyz + low.w / (low.w - high.w) * (high.xyz - low.xyz);
}
#ifdef FAN
uniform vec3 pivot;
void piece(int i, int j, int k) {
    vec3 a = crossing(corner[i], corner[j], corner_index[i] < corner_index[j]),
         b = crossing(corner[i], corner[k], corner_index[i] < corner_index[k]);
    bool lone_behind = corner[i].w < 0.0;
    put(pivot, vec3(0.0));
    put(lone_behind ? b : a, vec3(0.0));
    put(lone_behind ? a : b, vec3(0.0));
    EndPrimitive();
}
#else
in vec3 corner_normal[];
in vec3 corner_colour[];
uniform float width;   // [m]
void side(vec3 p, vec3 n, vec3 own, float inward) {
    n -= dot(n, plane.xyz) * plane.xyz;
    // Where the surface lies in the plane it has no side there.
    float size = length(n);
    put(p - (size > 1e-6 ? inward / size : 0.0) * n, own);
}
void piece(int i, int j, int k) {
    float t = corner[i].w / (corner[i].w - corner[j].w), u = corner[i].w / (corner[i].w - corner[k].w);
    vec3 a = crossing(corner[i], corner[j], corner_index[i] < corner_index[j]),
         b = crossing(corner[i], corner[k], corner_index[i] < corner_index[k]);
    vec3 a_normal = mix(corner_normal[i], corner_normal[j], t), b_normal = mix(corner_normal[i], corner_normal[k], u);
    vec3 a_own = mix(corner_colour[i], corner_colour[j], t), b_own = mix(corner_colour[i], corner_colour[k], u);
    side(a, a_normal, a_own, 0.0);
    side(b, b_normal, b_own, 0.0);
    side(a, a_normal, a_own, width);
    side(b, b_normal, b_own, width);
    EndPrimitive();
}
#endif
void main() {
    // Half-open, so that a corner in the plane belongs to one side. A triangle that is cut has one corner
    // by itself.
    bool a = corner[0].w < 0.0, b = corner[1].w < 0.0, c = corner[2].w < 0.0;
    if (a == b && b == c) {
        return;
    }
    if (b == c) {
        piece(0, 1, 2);
    } else if (a == c) {
        piece(1, 2, 0);
    } else {
        piece(2, 0, 1);
    }
}
)";

/// The plane itself, as far as `along` and `across` reach from `pivot`; draw four vertices as a strip.
inline constexpr std::string_view cut_plane_vertex = R"(
uniform mat4 view_projection;
uniform vec3 pivot;
uniform vec3 along;
uniform vec3 across;
uniform vec3 colour;
out vec3 world;
out vec3 colour_at;
void main() {
    vec2 corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
    world = pivot + corner.x * along + corner.y * across;
    colour_at = colour * colour * (0.75 + 0.25 * colour);
    gl_Position = view_projection * vec4(world, 1.0);
}
)";

/// What a cut shows: the plane with the fibres of what it cuts, and the band as it is.
inline constexpr std::string_view cut_fragment = R"(
in vec3 world;
in vec3 colour_at;
out vec4 pixel;
uniform float fibre;   // depth of the fibres' pattern, 0-1
uniform sampler2D grain;   // noise over 128 cells
void main() {
    vec3 c = colour_at;
    if (fibre > 0.0) {
        // Streaks of 0.4 by 4 mm across a mottle of 5 mm.
        float streak = texture(grain, vec2(world.y * 250.0 + world.z * 90.0, world.z * 2500.0 - world.y * 900.0) / 128.0).r;
        float mottle = texture(grain, (world.yz * 200.0 + 7.0) / 128.0).r;
        c *= 1.0 + fibre * (0.5 * streak + 0.5 * mottle - 0.5);
    }
    pixel = vec4(c, 1.0);
}
)";

}  // namespace eti::render::source
