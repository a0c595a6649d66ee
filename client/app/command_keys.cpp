// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/command_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eti::client {
namespace {

using namespace std::chrono_literals;

// A patient follows a step of a degree within a tenth of a second, and the news travel at 30 Hz.
constexpr auto followed_after = 1s;
// Steps of a degree while a key is held: the rate of a nurse's hands, 10 deg/s.
constexpr auto between_steps = 100ms;

// As on the assistant's keyboard (eti-controller).
constexpr std::array command_key_table{
    CommandKey{key_up, "up", "head_elevation", Stroke::step, 1.0f, "head up"},
    CommandKey{key_down, "down", "head_elevation", Stroke::step, -1.0f, "head down"},
    CommandKey{key_right, "right", "jaw_opening", Stroke::step, 1.0f, "jaw open"},
    CommandKey{key_left, "left", "jaw_opening", Stroke::step, -1.0f, "jaw closed"},
    CommandKey{U']', "]", "table_angle", Stroke::step, 1.0f, "table head-up"},
    CommandKey{U'[', "[", "table_angle", Stroke::step, -1.0f, "table head-down"},
    CommandKey{U'e', "e", "view_enhanced", Stroke::flip, 0.0f, "enhanced view on or off"},
    CommandKey{U's', "s", "suction", Stroke::hold, 0.0f, "suction while held"},
    CommandKey{U'r', "r", "reset", Stroke::once, 0.0f, "tissue and tube back to rest"},
};

}  // namespace

std::span<const CommandKey> command_keys() {
    return command_key_table;
}

const CommandKey* command_key(char32_t key) {
    const auto found = std::ranges::find(command_key_table, key, &CommandKey::key);
    return found == command_key_table.end() ? nullptr : &*found;
}

std::optional<WantedCommand> CommandTyping::press(const CommandKey& key, bool repeated,
                                                  const LiveValues& patient, Time now) {
    if (repeated && key.stroke != Stroke::step) {
        return std::nullopt;
    }
    const LiveField* const field = live_field(key.command);
    float value = 1.0f;
    if (key.stroke == Stroke::step || key.stroke == Stroke::flip) {
        const auto wish = wishes_.find(key.command);
        const bool pending = wish != wishes_.end() && now - wish->second.since < followed_after;
        if (pending && repeated && now - wish->second.since < between_steps) {
            return std::nullopt;
        }
        const float from = pending ? wish->second.value : patient.*field->value;
        value = key.stroke == Stroke::step ? field->clamped(from + key.step * field->per_unit)
                                           : (from > 0.5f ? 0.0f : 1.0f);
        // NaN: a server that does not say where its patient is cannot be asked for a step from there.
        if (std::isnan(from) || value == from) {
            return std::nullopt;
        }
    }
    wishes_[key.command] = {value, now};
    return WantedCommand{key.command, value};
}

std::optional<WantedCommand> CommandTyping::release(const CommandKey& key) {
    const auto wish = wishes_.find(key.command);
    if (key.stroke != Stroke::hold || wish == wishes_.end() || wish->second.value == 0.0f) {
        return std::nullopt;
    }
    wish->second.value = 0.0f;
    return WantedCommand{key.command, 0.0f};
}

}  // namespace eti::client
