// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Displacement of tissue by the blade: BladeClearanceDeformer of
// common/model/tools/blade_clearance_deformer.hpp. Include after its constants, which
// blade_clearance_source() writes. Draws nothing. Defines: none.
uniform mat4 to_blade;     // world to the tool's frame
uniform vec4 blade_plate;  // length, width at the heel and before the tip, crown [m]
uniform vec2 blade_crown;  // height of the crown at both [m]
uniform vec3 blade_lens;   // [m]
uniform vec3 blade_low, blade_high;  // box outside which nothing moves [m]
uniform vec4 mouth;        // nearer corner: side, position [m], displacement [m], end of the lips
                           // [m]
float blade_width(float along) {
    return mix(blade_plate.y, blade_plate.z,
               smoothstep(0.3 * blade_plate.x, 0.8 * blade_plate.x, along));
}
float blade_height(float along) {
    return mix(blade_crown.x, blade_crown.y, smoothstep(0.35 * blade_plate.x, 0.65 * blade_plate.x, along)) +
           0.8e-3 * smoothstep(blade_plate.x - 8e-3, blade_plate.x, along);
}
float blade_outline(float along) {
    float to_tip = clamp((blade_plate.x - along) / rounding, 0.0, 1.0);
    return 0.5 * blade_width(along) * (tip_width + (1.0 - tip_width) * sqrt(to_tip * (2.0 - to_tip)));
}
float depth_behind_face(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float from_middle = min(abs(p.x) / half_width, 1.0);
    return blade_height(p.z) - blade_plate.w * 2.0 * half_width / blade_plate.y * from_middle * from_middle +
           clearance - p.y;
}
float shift_past_tip(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float depth = depth_behind_face(p);
    float away = p.z - blade_plate.x;
    return tip_past * smoothstep(tip_from, deepest, depth) *
           (1.0 - smoothstep(tip_until, tip_ends, depth)) *
           (1.0 - smoothstep(half_width, half_width + tip_beside, abs(p.x))) *
           smoothstep(-tip_begins, -tip, away) * (1.0 - smoothstep(-tip, gathers * tip_past, away));
}
vec3 push_off_face(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float across = abs(p.x);
    float on_plate = (1.0 - smoothstep(half_width, half_width + beside, across)) *
                     (1.0 - smoothstep(blade_plate.x, blade_plate.x + beside, p.z));
    float depth = depth_behind_face(p);
    if (depth <= softness) {
        float deeper = max(depth + softness, 0.0);
        return p + vec3(0.0, on_plate * deeper * deeper / (4.0 * softness), 0.0);
    }
    float beyond = max(depth - deepest, 0.0);
    float left = steepest * (beyond < easing ? beyond * beyond / (2.0 * easing) : beyond - 0.5 * easing);
    float lens_depth = depth + p.y - blade_lens.y + lens_spare;
    float from = deepest + 0.5 * easing + lens_depth / steepest;
    float down = lens_depth - from;
    float stays = depth + down * (1.0 - smoothstep(from, from + gathers * down, depth)) *
                              (1.0 - smoothstep(lens_wholly, lens_fade, length(p.xz - blade_lens.xz)));
    float met = max(easing - abs(left - stays), 0.0);
    return p + vec3(0.0, on_plate * (depth - min(left, stays) + met * met / (4.0 * easing)), 0.0);
}
vec3 give_way(vec3 point) {
    vec3 start = (to_blade * vec4(point, 1.0)).xyz;
    if (any(lessThan(start, blade_low)) || any(greaterThan(start, blade_high))) {
        return point;
    }
    vec3 p = start;
    float along = smoothstep(heel, heel + beside, p.z);
    float crown = blade_height(p.z);
    float off = max(max(p.y - crown, crown - under - p.y), 0.0);
    float of_lips = 0.0;
    float aside = mouth.z;
    if (aside > 0.0) {
        of_lips = smoothstep(heel, heel + lips_fade, p.z) *
                  (1.0 - smoothstep(mouth.w, mouth.w + lips_fade, p.z)) *
                  (1.0 - smoothstep(0.0, lips_fade, p.z - blade_plate.x));
        float away = mouth.x * p.x - mouth.y;
        p.x += mouth.x * aside * of_lips * (1.0 - smoothstep(0.0, 1.5 * lips_fade, off)) *
               smoothstep(-3.0 * aside - 0.5 * spare, -0.5 * spare, away) *
               (1.0 - smoothstep(0.0, gathers * aside, away));
        of_lips *= min(aside / spare, 1.0);
    }
    p.z += (1.0 - of_lips) * shift_past_tip(p);
    p.y += blade_height(p.z) - crown;
    float past_tip = p.z - blade_plate.x;
    float outline = blade_outline(min(p.z, blade_plate.x - before_tip));
    float share = min(outline / edge_begins, 1.0);
    float away = (abs(p.x) - outline) / share;
    float over = clamp((away + edge_begins) / (edge_begins - edge), 0.0, 1.0);
    p.x += sign(p.x) * (1.0 - of_lips) * along * (1.0 - smoothstep(0.0, beside, past_tip)) *
           (1.0 - smoothstep(0.0, beside, off)) * share * edge_aside * over *
           (1.0 - smoothstep(-edge, gathers * edge_aside, away));
    p = mix(p, push_off_face(p), (1.0 - of_lips) * along);
    return point + transpose(mat3(to_blade)) * (p - start);
}
