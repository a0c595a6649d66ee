// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/blade_clearance_shader.hpp"

#include <fmt/format.h>

#include "client/render/draw_context.hpp"
#include "client/render/shaders/shaders.hpp"

namespace eti::render {

std::string blade_clearance_source() {
    std::string text;
    const auto constant = [&](const char* name, float value) {
        text += fmt::format("const float {} = {:.9e};\n", name, value);
    };
    constant("clearance", BladeClearanceDeformer::clearance);
    constant("softness", BladeClearanceDeformer::softness);
    constant("deepest", BladeClearanceDeformer::deepest);
    constant("steepest", BladeClearanceDeformer::steepest);
    constant("easing", BladeClearanceDeformer::easing);
    constant("beside", BladeClearanceDeformer::beside);
    constant("heel", BladeClearanceDeformer::heel);
    constant("under", BladeClearanceDeformer::under);
    constant("edge", BladeClearanceDeformer::edge);
    constant("edge_begins", BladeClearanceDeformer::edge_begins);
    constant("edge_aside", BladeClearanceDeformer::edge_aside);
    constant("before_tip", BladeClearanceDeformer::before_tip);
    constant("tip", BladeClearanceDeformer::tip);
    constant("tip_past", BladeClearanceDeformer::tip_past);
    constant("tip_begins", BladeClearanceDeformer::tip_begins);
    constant("tip_from", BladeClearanceDeformer::tip_from);
    constant("tip_until", BladeClearanceDeformer::tip_until);
    constant("tip_ends", BladeClearanceDeformer::tip_ends);
    constant("tip_beside", BladeClearanceDeformer::tip_beside);
    constant("spare", BladeClearanceDeformer::spare);
    constant("lips_fade", BladeClearanceDeformer::lips_fade);
    constant("lens_spare", BladeClearanceDeformer::lens_spare);
    constant("lens_wholly", BladeClearanceDeformer::lens_wholly);
    constant("lens_fade", BladeClearanceDeformer::lens_fade);
    constant("gathers", BladeClearanceDeformer::gathers);
    constant("rounding", BladePlate::rounding);
    constant("tip_width", BladePlate::tip_width);
    return text + std::string(shaders::give_way);
}

void apply(const PosedBladeClearanceDeformer& placed, ShaderProgram& program) {
    program.set("to_blade", matrix_of(placed.tool.inverse()));
    const BladeClearanceDeformer& give_way = placed.give_way;
    const BladePlate& plate = give_way.plate;
    program.set("blade_plate", Eigen::Vector4f(plate.length, plate.wide, plate.narrow, plate.crown));
    program.set("blade_crown", Eigen::Vector2f(plate.high, plate.low));
    program.set("blade_lens", give_way.lens);
    program.set("blade_low", Vec3f(give_way.where().min()));
    program.set("blade_high", Vec3f(give_way.where().max()));
    program.set("mouth", Eigen::Vector4f(give_way.side, give_way.corner, give_way.aside, give_way.lips_end));
}

}  // namespace eti::render
