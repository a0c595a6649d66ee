// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_pad.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace eti::devices {

namespace {

constexpr float dead_zone = 0.15f;  // for a stick at rest
constexpr std::string_view suction_name = "suction";
constexpr float suction_step = 0.1f;
constexpr std::size_t trigger = 5;     // right trigger of common pads: -1 released, 1 pressed
constexpr float settled_after = 1.0f;  // [s]

}  // namespace

const CommandPad::Motion CommandPad::turning{10.0f * degree, 0.5f * degree, false};
const CommandPad::Motion CommandPad::pressing{3.0f, 0.25f, true};

void CommandPad::follow(const RuntimeParameters& patient) {
    for (Target& target : targets_) {
        if (const float now = patient.*target.field.value;
            target.rested >= settled_after && std::isfinite(now)) {
            target.value = target.sent = target.field.clamped(now);
        }
    }
}

bool CommandPad::move(Target& target, float stick, float elapsed) {
    if (!target.value) {
        return false;
    }
    if (std::abs(stick) < dead_zone) {
        target.rested += elapsed;
        // The rest of the last move, when the stick comes to rest.
        const bool unsent = target.value != target.sent;
        target.sent = *target.value;
        return unsent;
    }
    target.rested = 0.0f;
    target.moved = true;
    target.value = target.field.clamped(*target.value + target.motion.rate * elapsed * stick);
    if (std::abs(*target.value - target.sent) < target.motion.sent_every) {
        return false;
    }
    target.sent = *target.value;
    return true;
}

std::vector<PadCommand> CommandPad::release() {
    std::vector<PadCommand> out;
    if (suction_ != 0.0f) {
        suction_ = 0.0f;
        out.push_back({suction_name, 0.0f});
    }
    for (Target& target : targets_) {
        if (target.motion.pressure && target.moved && target.value && *target.value != 0.0f) {
            target.value = target.sent = 0.0f;
            out.push_back({target.field.name, 0.0f});
        }
        target.moved = false;
    }
    return out;
}

std::vector<PadCommand> CommandPad::update(const Reading& reading, float elapsed) {
    if (!reading.present) {
        return release();
    }
    std::vector<PadCommand> out;
    for (Target& target : targets_) {
        if (move(target, target.sign * reading.axes[target.axis], elapsed)) {
            out.push_back({target.field.name, *target.value});
        }
    }
    trigger_seen_ = trigger_seen_ || reading.axes[trigger] < -0.5f;
    float wanted = (reading.buttons & 1u) != 0 ? 1.0f : 0.0f;
    if (trigger_seen_) {
        wanted = std::max(wanted, 0.5f * (reading.axes[trigger] + 1.0f));
    }
    const bool at_an_end = wanted == 0.0f || wanted == 1.0f;
    if (wanted != suction_ && (at_an_end || std::abs(wanted - suction_) >= suction_step)) {
        suction_ = wanted;
        out.push_back({suction_name, suction_});
    }
    return out;
}

}  // namespace eti::devices
