// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_pad.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace eti::devices {

namespace {

constexpr float rate = 10.0f * degree;       // [rad/s] at full deflection
constexpr float dead_zone = 0.15f;           // for a stick at rest
constexpr float sent_every = 0.5f * degree;  // [rad]
constexpr std::string_view suction_name = "suction";
constexpr float suction_step = 0.1f;
constexpr std::size_t trigger = 5;     // right trigger of common pads: -1 released, 1 pressed
constexpr float settled_after = 1.0f;  // [s]

}  // namespace

void CommandPad::follow(Posture& posture, const RuntimeParameters& patient) {
    const RuntimeParameterField& field = posture.field;
    if (const float now = patient.*field.value; posture.rested >= settled_after && std::isfinite(now)) {
        posture.value = posture.sent = field.clamped(now);
    }
}

void CommandPad::follow(const RuntimeParameters& patient) {
    follow(head_, patient);
    follow(jaw_, patient);
    follow(table_, patient);
}

bool CommandPad::move(Posture& posture, float stick, float elapsed) {
    if (!posture.value) {
        return false;
    }
    if (std::abs(stick) < dead_zone) {
        posture.rested += elapsed;
        // The rest of the last move, when the stick comes to rest.
        const bool unsent = posture.value != posture.sent;
        posture.sent = *posture.value;
        return unsent;
    }
    posture.rested = 0.0f;
    posture.value = posture.field.clamped(*posture.value + rate * elapsed * stick);
    if (std::abs(*posture.value - posture.sent) < sent_every) {
        return false;
    }
    posture.sent = *posture.value;
    return true;
}

std::vector<PadCommand> CommandPad::release() {
    if (suction_ == 0.0f) {
        return {};
    }
    suction_ = 0.0f;
    return {{suction_name, 0.0f}};
}

std::vector<PadCommand> CommandPad::update(const Reading& reading, float elapsed) {
    if (!reading.present) {
        return release();
    }
    std::vector<PadCommand> out;
    for (auto [posture, stick] : {std::pair{&head_, -reading.axes[1]}, std::pair{&jaw_, reading.axes[0]},
                                  std::pair{&table_, -reading.axes[4]}}) {
        if (move(*posture, stick, elapsed)) {
            out.push_back({posture->field.name, *posture->value});
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
