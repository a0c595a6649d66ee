// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/command_desk.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/math/units.hpp"

namespace eti::app {

namespace {

/// Takes a value within [0, most]; returns why not, or nothing.
std::string take(float value, float most, const char* what, const char* unit, float per_unit, float& to) {
    if (!std::isfinite(value) || value < 0.0f || value > most) {
        return fmt::format("{} {} {}, expected 0 to {:.0f}", what, value / per_unit, unit, most / per_unit);
    }
    to = value;
    return {};
}

}  // namespace

std::string_view name_of(msg::CommandKind kind) {
    constexpr std::array<std::string_view, 6> names = {"start",          "stop",        "reset",
                                                       "head_elevation", "jaw_opening", "suction"};
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
            refusal = take(command.value, anatomy::max_head_elevation, "head elevation", "deg", degree,
                           inputs.posture.head_elevation);
            break;
        case msg::COMMAND_JAW_OPENING:
            refusal = take(command.value, anatomy::max_jaw_opening, "jaw opening", "deg", degree,
                           inputs.posture.jaw_opening);
            break;
        case msg::COMMAND_SUCTION:
            refusal = take(command.value, 1.0f, "suction", "", 1.0f, suction_);
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

bool CommandDesk::take_reset() {
    return std::exchange(reset_, false);
}

}  // namespace eti::app
