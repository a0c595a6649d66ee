// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Anterior rise of chest and abdomen with a breath [m]. Its integral over the front of the trunk is a tidal volume of 5 mL/kg
// (4 to 6 mL/kg in volume-targeted ventilation: Keszler & Abubakar 2004, Pediatr Pulmonol 38:240); the abdomen rises more than the chest, and nothing above the shoulders.
// Draws nothing. Defines: none.
uniform vec2 breath;   // Breathing::inflation(), size relative to 3.5 kg
float chest_rise(vec3 rest) {
    if (breath.x == 0.0) {
        return 0.0;
    }
    // Model coordinates of the newborn, as NewbornSkin::to_model().
    vec3 q = vec3(rest.x, -rest.y, rest.z) / (1e-3 * breath.y) + vec3(0.0, 45.5, -6.9);
    float above = smoothstep(-25.0, 35.0, q.y);
    float beside = 1.0 - smoothstep(36.0, 72.0, abs(q.x));
    float along = smoothstep(-72.0, -150.0, q.z) * (1.0 - smoothstep(-175.0, -222.0, q.z));
    return 2e-3 * breath.x * breath.y * above * beside * along;
}
