// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_pad.hpp"

#include <algorithm>
#include <cmath>

namespace eti::devices {

namespace {

constexpr float rate = 10.0f * degree;       // [rad/s] at full deflection
constexpr float dead_zone = 0.15f;           // of a stick that rests
constexpr float sent_every = 0.5f * degree;  // [rad]
constexpr float suction_step = 0.1f;
constexpr std::size_t trigger = 5;     // right trigger of common pads: -1 released, 1 pressed
constexpr float settled_after = 1.0f;  // [s]

}  // namespace

void CommandPad::follow(Posture& posture, float told) {
    if (posture.rested >= settled_after && std::isfinite(told)) {
        posture.value = posture.sent = std::clamp(told, posture.least, posture.most);
    }
}

void CommandPad::follow(const msg::PatientState& patient) {
    follow(head_, patient.head_elevation());
    follow(jaw_, patient.jaw_opening());
    follow(table_, patient.table_angle());
}

bool CommandPad::move(Posture& posture, float stick, float elapsed) {
    if (!posture.value) {
        return false;
    }
    if (std::abs(stick) < dead_zone) {
        posture.rested += elapsed;
        // What is left of the last move, when the stick comes to rest.
        const bool unsent = posture.value != posture.sent;
        posture.sent = *posture.value;
        return unsent;
    }
    posture.rested = 0.0f;
    posture.value = std::clamp(*posture.value + rate * elapsed * stick, posture.least, posture.most);
    if (std::abs(*posture.value - posture.sent) < sent_every) {
        return false;
    }
    posture.sent = *posture.value;
    return true;
}

std::vector<PadCommand> CommandPad::let_go() {
    if (suction_ == 0.0f) {
        return {};
    }
    suction_ = 0.0f;
    return {{msg::COMMAND_SUCTION, 0.0f}};
}

std::vector<PadCommand> CommandPad::update(const Reading& reading, float elapsed) {
    if (!reading.present) {
        return let_go();
    }
    std::vector<PadCommand> out;
    for (auto [posture, stick] : {std::pair{&head_, -reading.axes[1]}, std::pair{&jaw_, reading.axes[0]},
                                  std::pair{&table_, -reading.axes[4]}}) {
        if (move(*posture, stick, elapsed)) {
            out.push_back({posture->kind, *posture->value});
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
        out.push_back({msg::COMMAND_SUCTION, suction_});
    }
    return out;
}

}  // namespace eti::devices
