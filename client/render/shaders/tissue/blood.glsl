// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Colour of tissue by the oxygen in its blood, see Circulation: blood without oxygen reflects less red and more blue,
// in proportion to the blood that shows. Draws nothing. Defines: none.
uniform vec3 circulation;   // cyanosis of the centre, of hands and feet; pallor: each 0-1
// `hair_or_acral`: of VertexRelief.
float acral_of(float hair_or_acral) { return clamp(1.0 - 2.008 * hair_or_acral, 0.0, 1.0); }
float hair_of(float hair_or_acral) { return clamp(1.992 * hair_or_acral - 0.992, 0.0, 1.0); }
// Doublings of red over green, by blood alone: 0.8 in skin, 1.6 in lips, 0 in cloth and bone.
float blood_in(vec3 albedo) { return clamp(log2(max(albedo.r, 1e-3) / max(albedo.g, 1e-3)), 0.0, 2.5); }
vec3 perfused(vec3 albedo, float acral) {
    float blood = blood_in(albedo);
    float blue = blood * mix(circulation.x, circulation.y, acral);
    vec3 doublings = blue * vec3(-0.62, -0.12, 0.28) + blood * circulation.z * vec3(0.03, 0.34, 0.30);
    return min(albedo * exp2(doublings), 1.0);
}
