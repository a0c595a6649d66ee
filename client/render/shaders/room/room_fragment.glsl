// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Matter of the room. Defines: FINE (reflections; with TERRY, loops of a towel), TERRY, ROOM_SHADOW, TAPS,
// ENVIRONMENT.
in vec3 world;
#include "scene/lighting.glsl"
in vec3 in_shade;
in vec3 from_room;
#ifdef FINE
in vec3 normal_at;
in float gloss;
float hash(vec2 p) {
    p = fract(p * vec2(0.1031, 0.1030));
    p += dot(p, p.yx + 33.33);
    return fract((p.x + p.y) * p.x);
}
#endif
void main() {
#ifdef ROOM_SHADOW
    float lit = unshadowed(room_depth, room_at);
#else
    const float lit = 1.0;
#endif
    vec3 sum = in_shade + lit * from_room;
#ifdef FINE
#ifdef TERRY
    // Loops 1.4 mm apart in staggered rows; at a distance they are finer than a pixel.
    vec2 loops = world.xz * 714.0;
    loops.x += 0.5 * mod(floor(loops.y), 2.0);
    vec2 inside = fract(loops) - 0.5;
    float tuft = 1.0 - 1.6 * dot(inside, inside) + 0.35 * (hash(floor(loops)) - 0.5);
    sum *= mix(0.92, 0.70 + 0.30 * tuft, 1.0 - smoothstep(0.25, 0.9, length(eye - world)));
#else
    vec3 v = normalize(eye - world);
    vec3 n = normalize(normal_at);
    float rim = 1.0 - clamp(dot(n, v), 0.0, 1.0);
    float at_normal = gloss > 0.99 ? 0.60 : 0.04;
    float fresnel = at_normal + (1.0 - at_normal) * rim * rim * rim * rim * rim;
    sum += min(1.6 * gloss, 1.0) * fresnel * mirrored(reflect(-v, n), 0.75 - 0.6 * gloss);
    Arriving light = unhindered(0, world);
    float nh = clamp(dot(n, normalize(light.direction + v)), 0.0, 1.0);
    sum += lit * light.colour * gloss * (at_normal + 0.02) * 4.0 * pow(nh, 8.0 + 120.0 * gloss) * step(0.0, dot(n, light.direction));
#endif
#endif
    pixel = vec4(min(sum, brightest), 1.0);
}
