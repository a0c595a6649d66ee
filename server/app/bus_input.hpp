// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/math/transform.hpp"
#include "common/process/line_limit.hpp"
#include "server/app/command_queue.hpp"

namespace eti::app {

/// Text of other people's packets, fit for logs and files: valid UTF-8 in one line, of at most `most` bytes.
[[nodiscard]] std::string readable(const std::string& text, std::size_t most = std::string::npos);

/// A tool's poses from the one device that is followed: the first found, while it is heard.
class FollowedDevice {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds silence{500};
    /// So long after its last pose another device may take its place; 50 poses of a tracker.
    static constexpr std::chrono::milliseconds patience{200};

    FollowedDevice(bus::Node& node, const bus::Topic<msg::ToolPose>& topic) : topic_(node, topic) {}

    /// Takes in what has come; the number of poses that were refused.
    std::uint64_t poll(Clock::time_point now);
    /// As last heard; empty: no device was there yet.
    [[nodiscard]] const std::optional<RigidTransform>& pose() const { return pose_; }
    [[nodiscard]] std::uint32_t buttons() const { return pressed_; }
    [[nodiscard]] msg::DevicePresence presence() const { return presence_; }

  private:
    bus::Subscriber<msg::ToolPose> topic_;
    msg::ToolPose message_;
    std::optional<RigidTransform> pose_;
    std::uint32_t pressed_ = 0;
    msg::DevicePresence presence_ = msg::DEVICE_NONE;
    Clock::time_point heard_{};
    bool let_go_ = false;
};

/// What arrived over the bus since the last step. Other people's packets are checked here: poses that
/// are not finite or lie more than two metres from the patient are dropped and counted, and nobody's commands
/// or annotations are more than a few a second.
class BusInput {
  public:
    explicit BusInput(bus::Node& node);

    /// Reads everything that is waiting; never blocks.
    void poll();

    [[nodiscard]] const FollowedDevice& laryngoscope() const { return laryngoscope_; }
    [[nodiscard]] const FollowedDevice& tube() const { return tube_; }
    [[nodiscard]] const std::optional<RigidTransform>& eye() const { return eye_; }
    [[nodiscard]] bool suction() const { return (laryngoscope_.buttons() & 1u) != 0; }
    /// Those to be carried out now.
    [[nodiscard]] std::vector<ReceivedCommand> take_commands();
    /// Those that a later one of their kind replaced.
    [[nodiscard]] std::vector<ReceivedCommand> take_replaced();
    /// What people write, point at and draw; texts and senders are readable().
    [[nodiscard]] std::vector<msg::Annotation> take_annotations();
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

  private:
    void poll_eye();
    void poll_commands();
    void poll_annotations();

    FollowedDevice laryngoscope_, tube_;
    bus::Subscriber<msg::EyePose> eye_topic_;
    bus::Subscriber<msg::Command> command_topic_;
    bus::Subscriber<msg::Annotation> annotation_topic_;
    msg::EyePose eye_message_;
    msg::Command command_;
    msg::Annotation annotation_;
    std::optional<RigidTransform> eye_;
    CommandQueue commands_;
    SenderAllowance annotations_allowed_{CommandQueue::per_second};
    std::vector<msg::Annotation> annotations_;
    LineLimit lines_;
    std::uint64_t refused_ = 0;
};

}  // namespace eti::app
