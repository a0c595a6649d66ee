// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hands_link.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/bus/codec/convert.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::hands {
namespace {

using namespace std::chrono_literals;

constexpr auto period = std::chrono::nanoseconds(1'000'000'000 / 240);
// By then a device that is already present has been discovered.
constexpr int cycles_before_writing = 240;
constexpr std::uint64_t longest_step_ns = 50'000'000;  // of simulation time; after a longer gap the hand
                                                       // did not move
// Equivalent compliance of the tube's resistance: at 2 N the fingers stop pushing.
constexpr float tube_compliance = 2e-3f;  // [m/N]

Overtravel overtravel_of(const msg::ProxyState& message) {
    const RigidTransform device = bus::from_msg(message.device()), proxy = bus::from_msg(message.proxy());
    return {device.translation - proxy.translation,
            rotation_vector(device.rotation * proxy.rotation.conjugate())};
}

float share_of(const Overtravel& overtravel) {
    const HandLimits limits;
    return std::min(1.0f, std::max(overtravel.translation.norm() / limits.max_overtravel,
                                   overtravel.rotation.norm() / limits.max_overtravel_angle));
}

}  // namespace

ToolWriter::ToolWriter(bus::Node& node, const bus::Topic<msg::ToolPose>& topic, std::string_view name)
    : name_(name), others_(node, topic), topic_(std::in_place, node, topic) {}

bool ToolWriter::has_ownership() {
    // One of the matched writers is this one.
    if (!ownership_lost_ && others_.matched() > 1) {
        ownership_lost_ = true;
        topic_.reset();
        spdlog::info("a device holds the {}: mouse and keys do not move it", name_);
    }
    return !ownership_lost_;
}

void ToolWriter::write(const RigidTransform& pose, bool suction, std::uint64_t time_ns) {
    if (!has_ownership()) {
        return;
    }
    msg::ToolPose message;
    message.header(bus::make_header(time_ns, ++number_));
    message.pose(bus::to_msg(pose));
    message.buttons(suction ? 1u : 0u);
    topic_->publish(message);
}

HandsLink::HandsLink(bus::Node& node, std::optional<HandPlayback> play)
    : description_(node, bus::topics::session_description),
      proxy_(node, bus::topics::proxy),
      metrics_(node, bus::topics::live_metrics),
      tube_force_(node, bus::topics::tube_force),
      blade_writer_(node, bus::topics::laryngoscope_pose, "laryngoscope"),
      tube_writer_(node, bus::topics::tube_pose, "tube"),
      play_(std::move(play)),
      thread_([this] { run(); }) {}

HandsLink::~HandsLink() {
    ending_ = true;
    thread_.join();
}

void HandsLink::run() {
    // Runs for microseconds: behind the renderer it would wait until the hand is considered silent.
    if (const std::string refused = set_real_time_priority(priority::loop); !refused.empty()) {
        spdlog::debug("hand input thread: {}", refused);
    }
    auto next = std::chrono::steady_clock::now();
    while (!ending_) {
        cycle();
        next = std::max(next + period, std::chrono::steady_clock::now());
        std::this_thread::sleep_until(next);
    }
}

void HandsLink::receive_messages() {
    while (description_.take(description_message_)) {
        const bool known = seen_.keys().has_value();
        const Laryngoscope scope = known ? seen_.keys()->laryngoscope() : Laryngoscope();
        const Tube tube = known ? seen_.keys()->tube() : Tube();
        // A new session's tools start at their start poses.
        if (seen_.apply(description_message_) && known &&
            (scope.blade_length != seen_.keys()->laryngoscope().blade_length ||
             tube.grip_from_tip != seen_.keys()->tube().grip_from_tip ||
             tube.curve_radius != seen_.keys()->tube().curve_radius)) {
            hands_.reset();
        }
    }
    if (metrics_.take_latest(metrics_message_)) {
        seen_.apply(metrics_message_);
    }
    if (proxy_.take_latest(proxy_message_) && seen_.apply(proxy_message_)) {
        blade_overtravel_ = overtravel_of(proxy_message_);
    }
    if (tube_force_.take_latest(force_message_)) {
        tube_overtravel_.translation = -tube_compliance * bus::from_msg(force_message_.force());
    }
}

void HandsLink::cycle() {
    receive_messages();
    const std::uint64_t now_ns = seen_.simulation_time_ns();
    const std::uint64_t passed = now_ns > time_ns_ ? std::min(now_ns - time_ns_, longest_step_ns) : 0;
    time_ns_ = now_ns;
    if (!seen_.keys() || !seen_.metrics()) {
        while (events_.front() != nullptr) {
            events_.pop();
        }
        return;
    }
    if (!hands_) {
        hands_.emplace(seen_.keys()->laryngoscope(), seen_.keys()->tube(), seen_.landmarks());
    }
    const float dt = 1e-9f * static_cast<float>(passed);
    for (; const Event* const event = events_.front(); events_.pop()) {
        if (const auto* const press = std::get_if<Press>(event)) {
            (void)hands_->press(press->key);
        } else if (const auto* const release = std::get_if<Release>(event)) {
            hands_->release(release->key);
        } else {
            hands_->drag(std::get<HandDrag>(*event), seen_.landmarks());
        }
    }
    if (++cycles_seen_ == cycles_before_writing && blade_writer_.has_ownership() &&
        tube_writer_.has_ownership()) {
        spdlog::info("mouse and keys control laryngoscope and tube");
    }
    if (cycles_seen_ > cycles_before_writing) {
        if (play_) {
            play_->advance(dt, *hands_, seen_, {});
        }
        hands_->advance(dt, blade_overtravel_, tube_overtravel_);
        blade_writer_.write(hands_->held(Tool::laryngoscope).pose(), false, now_ns);
        tube_writer_.write(hands_->held(Tool::tube).pose(), false, now_ns);
    }
    HandsState& state = newest_state_.draft();
    state.holding = cycles_seen_ > cycles_before_writing;
    state.chosen = hands_->chosen();
    state.owned = {!blade_writer_.ownership_lost(), !tube_writer_.ownership_lost()};
    state.held_back = share_of(hands_->chosen() == Tool::tube ? tube_overtravel_ : blade_overtravel_);
    state.poses = {blade_writer_.written(), tube_writer_.written()};
    if (play_) {
        state.played = play_->finished();
        state.view = play_->view();
    }
    newest_state_.post();
}

}  // namespace eti::hands
