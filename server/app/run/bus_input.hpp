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
#include "common/process/log_throttle.hpp"
#include "server/app/run/commands/command_queue.hpp"

namespace eti::app {

/// Sanitizes text from the network for logs and files: valid UTF-8 on one line, at most `most` bytes.
[[nodiscard]] std::string sanitized_text(const std::string& text, std::size_t most = std::string::npos);

/// Poses of a tool from one device: the first one discovered. While it is silent, another may take its
/// place, until the first has returned.
class FollowedDevice {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds silence_timeout{500};
    /// Another device may take over this long after the last pose; 50 poses of a tracker.
    static constexpr std::chrono::milliseconds takeover_timeout{200};

    FollowedDevice(bus::Node& node, const bus::Topic<msg::ToolPose>& topic) : topic_(node, topic) {}

    /// Reads pending samples; returns the number of rejected poses.
    std::uint64_t poll(Clock::time_point now);
    /// Last received pose; empty before the first.
    [[nodiscard]] const std::optional<RigidTransform>& pose() const { return pose_; }
    [[nodiscard]] std::uint32_t buttons() const { return pressed_; }
    [[nodiscard]] msg::DevicePresence presence() const { return presence_; }

  private:
    bus::Subscriber<msg::ToolPose> topic_;
    msg::ToolPose message_;
    std::optional<RigidTransform> pose_;
    std::uint32_t pressed_ = 0;
    msg::DevicePresence presence_ = msg::DEVICE_NONE;
    Clock::time_point last_heard_{};
    Clock::time_point released_{};  // last time, or last heard
};

/// Input received over the bus since the last step. Network data is validated here: poses that are not finite
/// or more than two metres from the patient are dropped and counted; commands and annotations are
/// rate-limited per sender.
class BusInput {
  public:
    explicit BusInput(bus::Node& node);

    /// Reads all pending samples; never blocks.
    void poll();

    [[nodiscard]] const FollowedDevice& laryngoscope() const { return laryngoscope_; }
    [[nodiscard]] const FollowedDevice& tube() const { return tube_; }
    [[nodiscard]] const std::optional<RigidTransform>& eye() const { return eye_; }
    [[nodiscard]] bool suction() const { return (laryngoscope_.buttons() & 1u) != 0; }
    /// Commands to execute now.
    [[nodiscard]] std::vector<ReceivedCommand> take_commands();
    /// Commands replaced by a later one of the same kind.
    [[nodiscard]] std::vector<ReceivedCommand> take_replaced();
    /// Annotations; texts and senders have passed sanitized_text().
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
    SenderRateLimiter annotation_limiter_{CommandQueue::per_second};
    std::vector<msg::Annotation> annotations_;
    LogThrottle lines_;
    std::uint64_t refused_ = 0;
};

}  // namespace eti::app
