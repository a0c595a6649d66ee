// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/command_handler.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/process/log_throttle.hpp"
#include "server/patient/model/swelling.hpp"

namespace eti::app {

namespace {

// Tolerance for a float's rounding of typed bounds, such as 1.4 or 20 degrees.
constexpr float rounding = 1e-6f;

/// Reason why a typed value is out of range, or an empty string.
std::string outside(const RuntimeParameterField& field, float typed, float low, float high) {
    const float slack = rounding * std::max(std::fabs(low), std::fabs(high));
    if (typed >= low - slack && typed <= high + slack) {
        return {};
    }
    return fmt::format("{} {:.4g}{}{}, expected {:.4g} to {:.4g}", field.label, typed,
                       field.unit.empty() ? "" : " ", field.unit, low, high);
}

}  // namespace

void CommandHandler::handle(const ReceivedCommand& command) {
    const std::string refusal = apply(command);
    answer_.recipient(command.sender);
    answer_.id(command.id);
    answer_.accepted(refusal.empty());
    answer_.reason(refusal);
    if (!refusal.empty()) {
        static LogThrottle limit;
        const std::string sender = sanitized_text(command.sender);
        if (const auto suppressed = limit.allow(sender)) {
            spdlog::warn("command {} of '{}' refused: {}{}", command.id, sender, refusal,
                         suppressed_suffix(*suppressed));
        }
    }
}

void CommandHandler::discard(const ReceivedCommand& command) {
    answer_.recipient(command.sender);
    answer_.id(command.id);
    answer_.accepted(true);
    answer_.reason("superseded by a later command of its kind");
}

std::string CommandHandler::apply(const ReceivedCommand& command) {
    if (command.name == "start") {
        return {};  // the simulation runs from the server's start
    }
    if (command.name == "stop") {
        stopped_ = true;
        return {};
    }
    if (command.name == "next") {
        next_ = has_next_session_;
        return has_next_session_
                   ? ""
                   : "this is the last session; start the server with several: --scenario A --scenario B";
    }
    if (command.name == "reset") {
        reset_ = true;
        return {};
    }
    const RuntimeParameterField* const field = find_runtime_parameter(command.name);
    if (field == nullptr) {
        return fmt::format("this server does not know '{}': it is older or newer than the sender",
                           command.name);
    }
    std::string refusal = refusal_of(*field, command.value);
    if (refusal.empty()) {
        wanted_.*field->value = field->clamped(command.value);
    }
    return refusal;
}

std::string CommandHandler::refusal_of(const RuntimeParameterField& field, float value) const {
    float low = field.low, high = field.high;
    if (field.value == &RuntimeParameters::tongue_scale) {
        low = std::max(low, patient::min_growth * limits_.tongue_scale);
        high = std::min(high, patient::max_growth * limits_.tongue_scale);
    }
    if (std::string refusal = outside(field, value / field.per_unit, low, high); !refusal.empty()) {
        return refusal;
    }
    if (field.on_off && value != 0.0f && value != 1.0f) {
        return fmt::format("{} {:.4g}, expected 0 or 1", field.label, value);
    }
    if (field.value == &RuntimeParameters::secretion && !limits_.saliva) {
        return "there is no liquid in this scenario; restart it with 'saliva: standby', which starts without "
               "saliva";
    }
    if (acts_on_yielding_bones(field) && !limits_.bones_yield && value != RuntimeParameters{}.*field.value) {
        return "the bones of this scenario do not yield; restart it with 'physics: {bones_yield: on}'";
    }
    return {};
}

bool CommandHandler::take_reset() {
    return std::exchange(reset_, false);
}

}  // namespace eti::app
