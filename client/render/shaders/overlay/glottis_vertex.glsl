// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The glottic opening's polygon. Defines: none.
layout(location = 0) in vec3 position;
uniform mat4 view_projection;
void main() { gl_Position = view_projection * vec4(position, 1.0); }
