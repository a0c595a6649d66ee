// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/command_desk.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/math/units.hpp"
#include "common/model/newborn_shape.hpp"
#include "server/patient/model/swelling.hpp"

namespace eti::app {

namespace {

// What a float's rounding may put beyond a bound that was typed, as 1.4 or 20 degrees.
constexpr float rounding = 1e-6f;

/// Where a value may lie, SI, and how it is said to a person.
struct Bounds {
    float least, most;
    const char* what;
    const char* unit = "";
    float per_unit = 1.0f;
};

/// Why a value does not lie within its bounds, or nothing.
std::string outside(float value, const Bounds& b) {
    const float slack = rounding * std::max(std::fabs(b.least), std::fabs(b.most));
    if (value >= b.least - slack && value <= b.most + slack) {
        return {};
    }
    return fmt::format("{} {:.4g}{}, expected {:.3g} to {:.3g}", b.what, value / b.per_unit, b.unit,
                       b.least / b.per_unit, b.most / b.per_unit);
}

/// Takes a value within its bounds; returns why not, or nothing.
std::string take(float value, const Bounds& bounds, float& to) {
    std::string refusal = outside(value, bounds);
    if (refusal.empty()) {
        to = std::clamp(value, bounds.least, bounds.most);
    }
    return refusal;
}

// Above ten times the usual flow (5 ml a minute in a term newborn) drops come out faster than ducts let them.
constexpr float most_secretion = 10.0f;

const ShapeField& field_of(float NewbornShape::*value) {
    return *std::ranges::find(shape_fields, value, &ShapeField::value);
}

}  // namespace

std::string_view name_of(msg::CommandKind kind) {
    constexpr std::array<std::string_view, 11> names = {"start",          "stop",         "reset",
                                                        "head_elevation", "jaw_opening",  "suction",
                                                        "table_angle",    "tongue_scale", "tissue_stiffness",
                                                        "secretion",      "head_scale"};
    const auto index = static_cast<std::size_t>(kind);
    return index < names.size() ? names[index] : "unknown";
}

void CommandDesk::handle(const ReceivedCommand& command, scene::Inputs& inputs) {
    std::string refusal;
    switch (command.kind) {
        case msg::COMMAND_START:
            break;  // the simulation runs from the server's start
        case msg::COMMAND_STOP:
            stopped_ = true;
            break;
        case msg::COMMAND_RESET:
            reset_ = true;
            break;
        case msg::COMMAND_HEAD_ELEVATION:
            refusal = take(command.value, {0.0f, max_head_elevation, "head elevation", " deg", degree},
                           inputs.posture.head_elevation);
            break;
        case msg::COMMAND_JAW_OPENING:
            refusal = take(command.value, {0.0f, max_jaw_opening, "jaw opening", " deg", degree},
                           inputs.posture.jaw_opening);
            break;
        case msg::COMMAND_TABLE_ANGLE:
            refusal = take(command.value, {-max_table_angle, max_table_angle, "table angle", " deg", degree},
                           inputs.posture.table_angle);
            break;
        case msg::COMMAND_SUCTION:
            refusal = take(command.value, {0.0f, 1.0f, "suction"}, suction_);
            break;
        case msg::COMMAND_HEAD_SCALE:
            refusal = grow_head(command.value, inputs);
            break;
        case msg::COMMAND_TONGUE_SCALE:
            refusal = grow_tongue(command.value, inputs);
            break;
        case msg::COMMAND_TISSUE_STIFFNESS:
            refusal = stiffen(command.value, inputs);
            break;
        case msg::COMMAND_SECRETION:
            refusal = secrete(command.value, inputs);
            break;
        default:
            refusal = "unknown command; this server is older than its sender";
            break;
    }
    answer_.recipient(command.sender.substr(0, 47));
    answer_.id(command.id);
    answer_.accepted(refusal.empty());
    answer_.reason(refusal.substr(0, 199));
    if (!refusal.empty()) {
        spdlog::warn("command {} of '{}' refused: {}", command.id, command.sender, refusal);
    }
}

std::string CommandDesk::grow_head(float scale, scene::Inputs& inputs) {
    const ShapeField& field = field_of(&NewbornShape::head_scale);
    float taken = 0.0f;
    std::string refusal = take(scale, {field.low, field.high, "head scale"}, taken);
    if (refusal.empty()) {
        inputs.head_scale = taken;
    }
    return refusal;
}

std::string CommandDesk::grow_tongue(float scale, scene::Inputs& inputs) const {
    const ShapeField& field = field_of(&NewbornShape::tongue_scale);
    const Bounds bounds{std::max(field.low, anatomy::least_growth * limits_.tongue_scale),
                        std::min(field.high, anatomy::most_growth * limits_.tongue_scale), "tongue scale"};
    if (std::string refusal = outside(scale, bounds); !refusal.empty()) {
        return refusal;
    }
    const float soft = inputs.tissue_stiffness.value_or(limits_.built_stiffness);
    if (soft > limits_.stiffest_at(scale)) {
        return fmt::format(
            "tongue scale {:.3g}: at {:.3g} kPa, {} grown so far bear {:.3g}; make the tissue softer first",
            scale, 1e-3f * soft, limits_.bearer, 1e-3f * limits_.stiffest_at(scale));
    }
    inputs.tongue_scale = std::clamp(scale, bounds.least, bounds.most);
    return {};
}

std::string CommandDesk::stiffen(float modulus, scene::Inputs& inputs) const {
    const Bounds bounds{limits_.softest, limits_.stiffest_typed, "tissue stiffness", " kPa", 1e3f};
    if (std::string refusal = outside(modulus, bounds); !refusal.empty()) {
        return refusal;
    }
    const float scale = inputs.tongue_scale.value_or(limits_.tongue_scale);
    if (modulus > limits_.stiffest_at(scale)) {
        return fmt::format(
            "tissue stiffness {:.3g} kPa, but {} bear at most {:.3g} in a tongue of scale {:.3g}; "
            "restart with more physics.substeps",
            1e-3f * modulus, limits_.bearer, 1e-3f * limits_.stiffest_at(scale), scale);
    }
    inputs.tissue_stiffness = modulus;
    return {};
}

std::string CommandDesk::secrete(float flow, scene::Inputs& inputs) const {
    if (!limits_.saliva) {
        return "there is no liquid in this scenario; restart it with 'saliva: standby', "
               "which has none until it is asked for";
    }
    return take(flow, {0.0f, most_secretion, "secretion"}, inputs.secretion);
}

bool CommandDesk::take_reset() {
    return std::exchange(reset_, false);
}

}  // namespace eti::app
