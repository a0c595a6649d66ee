// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/bus_input.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/convert.hpp"
#include "common/model/utf8.hpp"

namespace eti::app {

namespace {

constexpr float farthest_received_pose = 2.0f;  // [m] from the patient's origin
constexpr std::size_t most_messages = 256;      // per step and topic; the rest waits or is replaced

/// A pose that a hand or an eye can have, or nothing.
std::optional<RigidTransform> believable(const msg::Pose& pose) {
    const RigidTransform received = bus::from_msg(pose);
    const bool is_believable = bus::is_valid(pose) && received.translation.norm() < farthest_received_pose;
    return is_believable ? std::optional(received) : std::nullopt;
}

}  // namespace

std::string readable(const std::string& text, std::size_t most) {
    using nlohmann::json;
    // The library knows what is valid, and puts U+FFFD in the place of what is not.
    auto valid =
        json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
    std::ranges::replace_if(
        valid, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    valid.resize(whole_characters(valid, most));  // what was not valid has become longer
    return valid;
}

std::uint64_t FollowedDevice::poll(Clock::time_point now) {
    std::uint64_t refused = 0;
    if (topic_.take_latest(message_)) {
        if (const auto received = believable(message_.pose())) {
            pose_ = *received;
            pressed_ = message_.buttons();
            heard_ = now;
            let_go_ = false;
            presence_ = msg::DEVICE_HEARD;
        } else {
            ++refused;
        }
    }
    if (presence_ == msg::DEVICE_HEARD && !let_go_ && now - heard_ > patience) {
        let_go_ = true;
        topic_.let_go();
    }
    if (presence_ == msg::DEVICE_HEARD && now - heard_ > silence) {
        presence_ = msg::DEVICE_SILENT;
        pressed_ = 0;  // nobody holds a button that nobody reports
    }
    return refused;
}

BusInput::BusInput(bus::Node& node)
    : laryngoscope_(node, bus::topics::laryngoscope_pose),
      tube_(node, bus::topics::tube_pose),
      eye_topic_(node, bus::topics::eye_pose),
      command_topic_(node, bus::topics::command),
      annotation_topic_(node, bus::topics::annotation) {}

void BusInput::poll() {
    const auto now = FollowedDevice::Clock::now();
    refused_ += laryngoscope_.poll(now) + tube_.poll(now);
    poll_eye();
    poll_commands();
    poll_annotations();
}

void BusInput::poll_eye() {
    if (!eye_topic_.take_latest(eye_message_)) {
        return;
    }
    if (const auto received = believable(eye_message_.pose())) {
        eye_ = *received;
    } else {
        ++refused_;
    }
}

void BusInput::poll_commands() {
    for (std::size_t n = 0; n < most_messages && command_topic_.take(command_); ++n) {
        ReceivedCommand command{command_.sender().to_string(), static_cast<std::uint32_t>(command_.id()),
                                readable(command_.name().to_string()), command_.value()};
        if (!commands_.put(command_topic_.sender(), std::move(command))) {
            if (const auto kept_back = lines_.allow("command")) {
                spdlog::warn("a command of '{}' was left out: too many kinds or senders at once{}",
                             readable(command_.sender().to_string()), and_more(*kept_back));
            }
        }
    }
    std::string sender;
    if (const std::uint64_t replaced = commands_.take_flood(sender); replaced > 0) {
        if (const auto kept_back = lines_.allow("flood")) {
            spdlog::warn("'{}' sends more than {:.0f} commands a second: the last of each kind counts{}",
                         readable(sender), CommandQueue::per_second, and_more(*kept_back));
        }
    }
}

void BusInput::poll_annotations() {
    const auto now = Allowance::Clock::now();
    for (std::size_t n = 0; n < most_messages && annotation_topic_.take(annotation_); ++n) {
        annotation_.sender(readable(annotation_.sender().to_string(), msg::bound::Annotation_sender));
        annotation_.text(readable(annotation_.text().to_string(), msg::bound::Annotation_text));
        if (annotations_allowed_.take(annotation_topic_.sender(), now)) {
            annotations_.push_back(annotation_);
        } else if (const auto kept_back = lines_.allow("annotation")) {
            spdlog::warn("a remark or mark was left out, more than {:.0f} a second of one sender: {}: {}{}",
                         CommandQueue::per_second, annotation_.sender().to_string(),
                         annotation_.text().to_string(), and_more(*kept_back));
        }
    }
}

std::vector<ReceivedCommand> BusInput::take_commands() {
    return commands_.take_due(CommandQueue::Clock::now());
}

std::vector<ReceivedCommand> BusInput::take_replaced() {
    return commands_.take_replaced(CommandQueue::Clock::now());
}

std::vector<msg::Annotation> BusInput::take_annotations() {
    return std::exchange(annotations_, {});
}

}  // namespace eti::app
