// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/bus_input.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/codec/convert.hpp"
#include "common/model/utf8.hpp"

namespace eti::app {

namespace {

constexpr float max_received_distance = 2.0f;  // [m] from the patient's origin
constexpr std::size_t max_messages = 256;      // per step and topic; the rest is queued or replaced

}  // namespace

std::string sanitized_text(const std::string& text, std::size_t most) {
    using nlohmann::json;
    // The library validates UTF-8, and replaces invalid bytes by U+FFFD.
    auto valid =
        json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
    std::ranges::replace_if(
        valid, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    valid.resize(utf8_prefix_length(valid, most));  // replacements are longer than the invalid bytes
    return valid;
}

std::uint64_t FollowedDevice::poll(Clock::time_point now) {
    std::uint64_t refused = 0;
    if (topic_.take_latest(message_)) {
        if (const auto received = bus::valid_pose(message_.pose(), max_received_distance)) {
            pose_ = *received;
            pressed_ = message_.buttons();
            last_heard_ = released_ = now;
            presence_ = msg::DEVICE_HEARD;
        } else {
            ++refused;
        }
    }
    // Again and again: one that sends nothing but invalid poses is no device to stay with.
    if (presence_ != msg::DEVICE_NONE && now - released_ > takeover_timeout) {
        released_ = now;
        topic_.release_ownership();
    }
    if (presence_ == msg::DEVICE_HEARD && now - last_heard_ > silence_timeout) {
        presence_ = msg::DEVICE_SILENT;
        pressed_ = 0;  // without reports, no button is pressed
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
    if (const auto received = bus::valid_pose(eye_message_.pose(), max_received_distance)) {
        eye_ = *received;
    } else {
        ++refused_;
    }
}

void BusInput::poll_commands() {
    for (std::size_t n = 0; n < max_messages && command_topic_.take(command_); ++n) {
        ReceivedCommand command{command_.sender().to_string(), static_cast<std::uint32_t>(command_.id()),
                                sanitized_text(command_.name().to_string()), command_.value()};
        if (!commands_.put(command_topic_.sender(), std::move(command))) {
            if (const auto suppressed = lines_.allow("command")) {
                spdlog::warn("a command of '{}' was ignored: too many kinds or senders at once{}",
                             sanitized_text(command_.sender().to_string()), suppressed_suffix(*suppressed));
            }
        }
    }
    std::string sender;
    if (const std::uint64_t replaced = commands_.take_replaced_count(sender); replaced > 0) {
        if (const auto suppressed = lines_.allow("flood")) {
            spdlog::warn(
                "'{}' sends more than {:.0f} commands per second: only the last of each kind is used{}",
                sanitized_text(sender), CommandQueue::per_second, suppressed_suffix(*suppressed));
        }
    }
}

void BusInput::poll_annotations() {
    const auto now = RateLimiter::Clock::now();
    for (std::size_t n = 0; n < max_messages && annotation_topic_.take(annotation_); ++n) {
        annotation_.sender(sanitized_text(annotation_.sender().to_string(), msg::bound::Annotation_sender));
        annotation_.text(sanitized_text(annotation_.text().to_string(), msg::bound::Annotation_text));
        if (annotation_limiter_.try_acquire(annotation_topic_.sender(), now)) {
            annotations_.push_back(annotation_);
        } else if (const auto suppressed = lines_.allow("annotation")) {
            spdlog::warn(
                "a remark or mark was ignored, more than {:.0f} per second from one sender: {}: {}{}",
                CommandQueue::per_second, annotation_.sender().to_string(), annotation_.text().to_string(),
                suppressed_suffix(*suppressed));
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
