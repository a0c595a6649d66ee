// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_link.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "common/bus/convert.hpp"
#include "common/math/units.hpp"
#include "common/scenario/scenario.hpp"

namespace eti::devices {

namespace {

struct Key {
    std::string_view name;
    msg::CommandKind kind;
    float unit;  // SI value of one typed unit
    std::string_view range;
};

// Ranges are told here and enforced by the server, which knows what its patient bears.
constexpr std::array<Key, 8> keys = {
    {{"head_elevation_deg", msg::COMMAND_HEAD_ELEVATION, degree, "0 to 30"},
     {"jaw_opening_deg", msg::COMMAND_JAW_OPENING, degree, "0 to 35"},
     {"table_angle_deg", msg::COMMAND_TABLE_ANGLE, degree, "-20 to 20, positive head-up"},
     {"head_scale", msg::COMMAND_HEAD_SCALE, 1.0f, "0.85 to 1.15"},
     {"tongue_scale", msg::COMMAND_TONGUE_SCALE, 1.0f, "0.8 to 1.4"},
     {"tissue_stiffness_kpa", msg::COMMAND_TISSUE_STIFFNESS, 1e3f, "1 to what the solver bears"},
     {"secretion", msg::COMMAND_SECRETION, 1.0f, "0 to 10, 1 is usual"},
     {"suction", msg::COMMAND_SUCTION, 1.0f, "0 to 1"}}};

}  // namespace

std::string command_keys() {
    std::string text;
    for (const Key& key : keys) {
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", key.name, key.range);
    }
    return text;
}

PadCommand command_from(const std::string& typed) {
    const std::size_t equals = typed.find('=');
    const auto key = std::ranges::find(keys, std::string_view(typed).substr(0, equals), &Key::name);
    if (equals == std::string::npos || key == keys.end()) {
        throw InputError(fmt::format("--set {}: expected KEY=VALUE with a key of {}", typed, command_keys()));
    }
    float value = 0.0f;
    const char* const end = typed.data() + typed.size();
    const auto [stop, error] = std::from_chars(typed.data() + equals + 1, end, value);
    if (error != std::errc() || stop != end) {
        throw InputError(fmt::format("--set {}: expected a plain number after '=', {}", typed, key->range));
    }
    return {key->kind, value * key->unit};
}

CommandLink::CommandLink(const bus::Options& options)
    : node_(options),
      commands_(node_, bus::topics::command),
      answers_(node_, bus::topics::command_result),
      status_(node_, bus::topics::session_status),
      live_(node_, bus::topics::live_metrics) {}

void CommandLink::send(const PadCommand& command) {
    msg::Command message;
    message.header(bus::make_header(0, ++sent_));
    message.sender(sender_);
    message.id(sent_);
    message.kind(command.kind);
    message.value(command.value);
    if (!commands_.publish(message)) {
        spdlog::warn("a command could not be sent: no server takes it");
    }
}

void CommandLink::hear() {
    msg::CommandResult answer;
    while (answers_.take(answer)) {
        if (answer.recipient().to_string() != sender_) {
            continue;
        }
        ++(answer.accepted() ? accepted_ : refused_);
        if (!answer.accepted()) {
            spdlog::warn("refused: {}", answer.reason().to_string());
        }
    }
    msg::SessionStatus status;
    while (status_.take(status)) {
        session_finished_ = session_finished_ || status.phase() == msg::PHASE_FINISHED;
    }
    msg::LiveMetrics live;
    if (live_.take_latest(live)) {
        patient_ = live.patient();
    }
}

bool CommandLink::hear_all(std::chrono::milliseconds patience) {
    const auto limit = std::chrono::steady_clock::now() + patience;
    while (accepted_ + refused_ < sent_ && std::chrono::steady_clock::now() < limit) {
        (void)answers_.wait(std::chrono::milliseconds(50));
        hear();
    }
    return accepted_ + refused_ == sent_;
}

}  // namespace eti::devices
