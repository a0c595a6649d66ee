// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/give_way_shader.hpp"

#include <fmt/format.h>

namespace eti::render {

namespace {

constexpr const char* source = R"(
uniform mat4 to_blade;     // world to the tool's frame
uniform vec3 blade_up;     // its +y in the world
uniform vec4 blade_plate;  // length, width at the heel and before the tip, crown [m]
uniform vec2 blade_crown;  // height of the crown there [m]
float blade_width(float along) {
    return mix(blade_plate.y, blade_plate.z,
               smoothstep(0.3 * blade_plate.x, 0.8 * blade_plate.x, along));
}
float blade_height(float along) {
    return mix(blade_crown.x, blade_crown.y, smoothstep(0.35 * blade_plate.x, 0.65 * blade_plate.x, along)) +
           0.8e-3 * smoothstep(blade_plate.x - 8e-3, blade_plate.x, along);
}
vec3 give_way(vec3 point) {
    vec3 p = (to_blade * vec4(point, 1.0)).xyz;
    float half_width = 0.5 * blade_width(p.z);
    float across = abs(p.x);
    float on_plate = (1.0 - smoothstep(half_width, half_width + beside, across)) *
                     smoothstep(heel, heel + beside, p.z) *
                     (1.0 - smoothstep(blade_plate.x, blade_plate.x + beside, p.z));
    float edge = min(across / half_width, 1.0);
    float face = blade_height(p.z) - blade_plate.w * 2.0 * half_width / blade_plate.y * edge * edge;
    float depth = face + clearance - p.y;
    float deeper = clamp(depth + softness, 0.0, 2.0 * softness);
    float outwards = depth > softness ? depth : deeper * deeper / (4.0 * softness);
    return point + blade_up * on_plate * outwards * (1.0 - smoothstep(deepest, deepest + release, depth));
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
    constant("release", GiveWay::release);
    constant("beside", GiveWay::beside);
    constant("heel", GiveWay::heel);
    return text + source;
}

void apply(const GiveWay& give_way, const RigidTransform& tool, ShaderProgram& program) {
    const RigidTransform inverse = tool.inverse();
    Eigen::Matrix4f to_blade = Eigen::Matrix4f::Identity();
    to_blade.topLeftCorner<3, 3>() = inverse.rotation.toRotationMatrix();
    to_blade.topRightCorner<3, 1>() = inverse.translation;
    program.set("to_blade", to_blade);
    program.set("blade_up", Vec3f(tool.rotation * Vec3f::UnitY()));
    const BladePlate& plate = give_way.plate;
    program.set("blade_plate", Eigen::Vector4f(plate.length, plate.wide, plate.narrow, plate.crown));
    program.set("blade_crown", Eigen::Vector2f(plate.high, plate.low));
}

}  // namespace eti::render
