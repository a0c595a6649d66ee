// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// One unlit colour: object ids; depth and stencil only if colour writes are off. Defines:
// BOTH_SIDES (another colour for back faces), BY_TISSUE (each vertex's tissue label).
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
