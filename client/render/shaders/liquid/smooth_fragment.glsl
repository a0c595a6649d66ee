// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// One direction of a separable bilateral filter of the liquid's depth: samples that differ by more
// than a few radii belong to another surface. Defines: none.
in vec2 at;
uniform sampler2D depth;
uniform vec2 pixel;             // step to the next pixel, along one direction
uniform float radius;           // [m]
uniform float sphere_pixels;    // diameter of a sphere at one metre
uniform float width;            // half width of the filter, in spheres
out float value;
void main() {
    float here = texture(depth, at).r;
    value = here;
    if (here <= 0.0) {
        return;
    }
    float stride = clamp(sphere_pixels / here * width / 6.0, 1.0, 8.0);
    float sum = here, weights = 1.0;
    for (int i = 1; i <= 6; ++i) {
        for (int side = -1; side <= 1; side += 2) {
            float other = texture(depth, at + float(i * side) * stride * pixel).r;
            float apart = (other - here) / (2.0 * radius);
            float weight = other > 0.0 ? exp(-float(i * i) / 12.0 - apart * apart) : 0.0;
            sum += weight * other;
            weights += weight;
        }
    }
    value = sum / weights;
}
