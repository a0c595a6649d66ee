// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The final picture from the scene's light. Defines: TONE (vignette, fogging and filmic curve;
// without it values are copied).
#ifdef TONE
#include "overlay/tone_corner.glsl"
#endif
in vec2 at;
out vec4 pixel;
uniform sampler2D light;
#ifdef TONE
flat in float taken;
uniform float vignette;
uniform float fogging;
// Filmic curve of Narkowicz 2015; keeps highlights from clipping to flat white.
vec3 film(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
#endif
void main() {
    vec3 c = texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb;
#ifdef TONE
    float out_here = out_of_middle(at);
    c *= taken * (1.0 - vignette * 0.92 * in_corner(out_here));
    // Droplets scatter the light that passes and add light of their own.
    float fog = fogging * (1.0 - 0.6 * smoothstep(0.3, 1.3, out_here));
    c = film(mix(c, vec3(0.30, 0.29, 0.29), 0.85 * fog));
#endif
    pixel = vec4(c, 1.0);
}
