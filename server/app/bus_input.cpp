// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/bus_input.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/convert.hpp"

namespace eti::app {

namespace {

constexpr float farthest = 2.0f;           // [m] from the patient's origin
constexpr std::size_t most_commands = 64;  // per step; more is a fault of the sender

}  // namespace

std::string readable(const std::string& text) {
    using nlohmann::json;
    // The library knows what is valid, and puts U+FFFD in the place of what is not.
    auto valid =
        json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
    std::ranges::replace_if(
        valid, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return valid;
}

BusInput::BusInput(bus::Node& node)
    : laryngoscope_topic_(node, bus::topics::laryngoscope_pose),
      tube_topic_(node, bus::topics::tube_pose),
      eye_topic_(node, bus::topics::eye_pose),
      command_topic_(node, bus::topics::command) {}

void BusInput::latch(const msg::Pose& pose, std::optional<RigidTransform>& to) {
    const RigidTransform received = bus::from_msg(pose);
    if (bus::is_valid(pose) && received.translation.norm() < farthest) {
        to = received;
    } else {
        ++refused_;
    }
}

void BusInput::poll() {
    if (laryngoscope_topic_.take_latest(tool_)) {
        latch(tool_.pose(), laryngoscope_);
        suction_ = (tool_.buttons() & 1u) != 0;
    }
    if (tube_topic_.take_latest(tool_)) {
        latch(tool_.pose(), tube_);
    }
    if (eye_topic_.take_latest(eye_message_)) {
        latch(eye_message_.pose(), eye_);
    }
    for (std::size_t n = 0; n < most_commands && command_topic_.take(command_); ++n) {
        commands_.push_back({command_.sender().to_string(), static_cast<std::uint32_t>(command_.id()),
                             readable(command_.name().to_string()), command_.value()});
    }
}

std::vector<ReceivedCommand> BusInput::take_commands() {
    return std::exchange(commands_, {});
}

}  // namespace eti::app
