// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Shadow map lookups. Defines: ROOM_SHADOW, LAMP_SHADOW, TAPS (samples per side of the kernel),
// LOOKED_UP (empty if the shader itself computes the shadow map coordinates).
#ifndef LOOKED_UP
#define LOOKED_UP in
#endif
layout(location = 0) out vec4 pixel;
// Upper limit of a highlight; brighter ones would leave jagged edges after multisampling.
const vec3 brightest = vec3(8.0);
uniform vec3 eye;
#ifdef ROOM_SHADOW
LOOKED_UP vec3 room_at;
uniform sampler2DShadow room_depth;
#endif
#ifdef LAMP_SHADOW
LOOKED_UP vec3 lamp_at;
uniform sampler2DShadow lamp_depth;
#endif

#if defined(ROOM_SHADOW) || defined(LAMP_SHADOW)
// Fraction of a light that arrives: mean of TAPS x TAPS samples, each two texels wide.
float unshadowed(sampler2DShadow map, vec3 p) {
    float texel = 1.5 / float(textureSize(map, 0).x);
    float sum = 0.0;
    for (int y = 0; y < TAPS; ++y) {
        for (int x = 0; x < TAPS; ++x) {
            vec2 aside = vec2(x, y) - 0.5 * float(TAPS - 1);
            sum += texture(map, vec3(p.xy + aside * texel, p.z));
        }
    }
    return sum / float(TAPS * TAPS);
}
#endif
