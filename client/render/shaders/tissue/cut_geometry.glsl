// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Turns a triangle that the section plane intersects into a segment of the contour. Defines: FAN.
//
// With FAN: the triangle from `pivot`, a point of the plane, to the segment. Segments are oriented
// with the inside on one side, so that a point is inside if more triangles turn one way than the
// other, even where a surface intersects itself.
//
// Without FAN: a band of `width` inside the contour in the surface's own colour, which keeps skin,
// mucosa and cords recognisable along the section.
#include "scene/linear_colour.glsl"
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
    colour_at = linear(c);
    gl_Position = view_projection * vec4(p, 1.0);
    EmitVertex();
}
// Always from the same end, so that the segments of both triangles at an edge meet in one point.
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
    // A surface parallel to the plane has no inward direction.
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
    // Half-open, so that a corner in the plane belongs to one side. An intersected triangle has one
    // corner alone on its side.
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
