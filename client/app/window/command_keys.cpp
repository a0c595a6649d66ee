// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/command_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/text/catalogue.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;
using text::translatable;

// A patient follows a step of one degree within a tenth of a second, and metrics arrive at 30 Hz.
constexpr auto pending_timeout = 1s;
// One-degree steps while a key is held: the rate of an assistant's hands, 10 deg/s.
constexpr auto repeat_interval = 100ms;

// As on the assistant's keyboard (eti-controller).
constexpr std::array command_key_table{
    CommandKey{key_up, translatable("up"), "head_elevation", KeyAction::step, 1.0f, translatable("head up")},
    CommandKey{key_down, translatable("down"), "head_elevation", KeyAction::step, -1.0f,
               translatable("head down")},
    CommandKey{key_right, translatable("right"), "jaw_opening", KeyAction::step, 1.0f,
               translatable("jaw open")},
    CommandKey{key_left, translatable("left"), "jaw_opening", KeyAction::step, -1.0f,
               translatable("jaw closed")},
    CommandKey{U']', "]", "table_angle", KeyAction::step, 1.0f, translatable("table head-up")},
    CommandKey{U'[', "[", "table_angle", KeyAction::step, -1.0f, translatable("table head-down")},
    CommandKey{U'e', "e", "view_enhanced", KeyAction::toggle, 0.0f, translatable("enhanced view on or off")},
    CommandKey{U's', "s", "suction", KeyAction::hold, 1.0f, translatable("suction while held")},
    CommandKey{U'-', "-", "laryngeal_pressure_back", KeyAction::hold, 3.0f,
               translatable("larynx pressed back while held")},
    CommandKey{U'r', "r", "reset", KeyAction::once, 0.0f, translatable("reset tissue and tube")},
};

}  // namespace

std::span<const CommandKey> command_keys() {
    return command_key_table;
}

const CommandKey* command_key(char32_t key) {
    const auto found = std::ranges::find(command_key_table, key, &CommandKey::key);
    return found == command_key_table.end() ? nullptr : &*found;
}

std::optional<CommandRequest> CommandKeyMapper::press(const CommandKey& key, bool repeated,
                                                      const RuntimeParameters& patient, Time now) {
    if (repeated && key.action != KeyAction::step) {
        return std::nullopt;
    }
    const RuntimeParameterField* const field = find_runtime_parameter(key.command);
    float value = key.action == KeyAction::hold ? field->clamped(key.amount * field->per_unit) : 1.0f;
    if (key.action == KeyAction::step || key.action == KeyAction::toggle) {
        const auto entry = pending_.find(key.command);
        const bool pending = entry != pending_.end() && now - entry->second.since < pending_timeout;
        if (pending && repeated && now - entry->second.since < repeat_interval) {
            return std::nullopt;
        }
        const float from = pending ? entry->second.value : patient.*field->value;
        value = key.action == KeyAction::step ? field->clamped(from + key.amount * field->per_unit)
                                              : (from > 0.5f ? 0.0f : 1.0f);
        // NaN: a step needs the current value, which the server does not publish.
        if (std::isnan(from) || value == from) {
            return std::nullopt;
        }
    }
    pending_[key.command] = {value, now};
    return CommandRequest{key.command, value};
}

std::optional<CommandRequest> CommandKeyMapper::release(const CommandKey& key) {
    const auto entry = pending_.find(key.command);
    if (key.action != KeyAction::hold || entry == pending_.end() || entry->second.value == 0.0f) {
        return std::nullopt;
    }
    entry->second.value = 0.0f;
    return CommandRequest{key.command, 0.0f};
}

}  // namespace eti::client
