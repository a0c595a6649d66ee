// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/give_way_shader.hpp"

#include <fmt/format.h>

namespace eti::render {

namespace {

constexpr const char* source = R"(
uniform mat4 to_blade;     // world to the tool's frame
uniform vec4 blade_plate;  // length, width at the heel and before the tip, crown [m]
uniform vec2 blade_crown;  // height of the crown there [m]
uniform vec3 blade_lens;   // [m]
uniform vec3 blade_low, blade_high;  // of the box out of which nothing moves [m]
uniform vec4 mouth;        // nearer corner: side, where [m], by how much it goes aside [m], end of lips [m]
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
float behind_the_face(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float from_middle = min(abs(p.x) / half_width, 1.0);
    return blade_height(p.z) - blade_plate.w * 2.0 * half_width / blade_plate.y * from_middle * from_middle +
           clearance - p.y;
}
float past_the_tip(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float depth = behind_the_face(p);
    float away = p.z - blade_plate.x;
    return tip_past * smoothstep(tip_from, deepest, depth) *
           (1.0 - smoothstep(tip_until, tip_ends, depth)) *
           (1.0 - smoothstep(half_width, half_width + tip_beside, abs(p.x))) *
           smoothstep(-tip_begins, -tip, away) * (1.0 - smoothstep(-tip, gathers * tip_past, away));
}
vec3 off_the_face(vec3 p) {
    float half_width = 0.5 * blade_width(p.z);
    float across = abs(p.x);
    float on_plate = (1.0 - smoothstep(half_width, half_width + beside, across)) *
                     (1.0 - smoothstep(blade_plate.x, blade_plate.x + beside, p.z));
    float depth = behind_the_face(p);
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
    p.z += (1.0 - of_lips) * past_the_tip(p);
    p.y += blade_height(p.z) - crown;
    float past_tip = p.z - blade_plate.x;
    float outline = blade_outline(min(p.z, blade_plate.x - before_tip));
    float share = min(outline / edge_begins, 1.0);
    float away = (abs(p.x) - outline) / share;
    float over = clamp((away + edge_begins) / (edge_begins - edge), 0.0, 1.0);
    p.x += sign(p.x) * (1.0 - of_lips) * along * (1.0 - smoothstep(0.0, beside, past_tip)) *
           (1.0 - smoothstep(0.0, beside, off)) * share * edge_aside * over *
           (1.0 - smoothstep(-edge, gathers * edge_aside, away));
    p = mix(p, off_the_face(p), (1.0 - of_lips) * along);
    return point + transpose(mat3(to_blade)) * (p - start);
}
)";

}  // namespace

std::string give_way_source() {
    std::string text;
    const auto constant = [&](const char* name, float value) {
        text += fmt::format("const float {} = {:.9e};\n", name, value);
    };
    constant("clearance", GiveWay::clearance);
    constant("softness", GiveWay::softness);
    constant("deepest", GiveWay::deepest);
    constant("steepest", GiveWay::steepest);
    constant("easing", GiveWay::easing);
    constant("beside", GiveWay::beside);
    constant("heel", GiveWay::heel);
    constant("under", GiveWay::under);
    constant("edge", GiveWay::edge);
    constant("edge_begins", GiveWay::edge_begins);
    constant("edge_aside", GiveWay::edge_aside);
    constant("before_tip", GiveWay::before_tip);
    constant("tip", GiveWay::tip);
    constant("tip_past", GiveWay::tip_past);
    constant("tip_begins", GiveWay::tip_begins);
    constant("tip_from", GiveWay::tip_from);
    constant("tip_until", GiveWay::tip_until);
    constant("tip_ends", GiveWay::tip_ends);
    constant("tip_beside", GiveWay::tip_beside);
    constant("spare", GiveWay::spare);
    constant("lips_fade", GiveWay::lips_fade);
    constant("lens_spare", GiveWay::lens_spare);
    constant("lens_wholly", GiveWay::lens_wholly);
    constant("lens_fade", GiveWay::lens_fade);
    constant("gathers", GiveWay::gathers);
    constant("rounding", BladePlate::rounding);
    constant("tip_width", BladePlate::tip_width);
    return text + source;
}

void apply(const PlacedGiveWay& placed, ShaderProgram& program) {
    const RigidTransform inverse = placed.tool.inverse();
    Eigen::Matrix4f to_blade = Eigen::Matrix4f::Identity();
    to_blade.topLeftCorner<3, 3>() = inverse.rotation.toRotationMatrix();
    to_blade.topRightCorner<3, 1>() = inverse.translation;
    program.set("to_blade", to_blade);
    const GiveWay& give_way = placed.give_way;
    const BladePlate& plate = give_way.plate;
    program.set("blade_plate", Eigen::Vector4f(plate.length, plate.wide, plate.narrow, plate.crown));
    program.set("blade_crown", Eigen::Vector2f(plate.high, plate.low));
    program.set("blade_lens", give_way.lens);
    program.set("blade_low", Vec3f(give_way.where().min()));
    program.set("blade_high", Vec3f(give_way.where().max()));
    program.set("mouth", Eigen::Vector4f(give_way.side, give_way.corner, give_way.aside, give_way.lips_end));
}

}  // namespace eti::render
