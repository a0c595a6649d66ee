// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/math/transform.hpp"

namespace eti::app {

/// Text of other people's packets, fit for logs and files: valid UTF-8 in one line.
[[nodiscard]] std::string readable(const std::string& text);

/// A command as it came in; the server answers every one.
struct ReceivedCommand {
    std::string sender;
    std::uint32_t id = 0;
    std::string name;
    float value = 0.0f;  ///< SI
};

/// What arrived over the bus since the last step. Other people's packets are checked here: poses that
/// are not finite or lie more than two metres from the patient are dropped and counted.
class BusInput {
  public:
    explicit BusInput(bus::Node& node);

    /// Reads everything that is waiting; never blocks.
    void poll();

    [[nodiscard]] const std::optional<RigidTransform>& laryngoscope() const { return laryngoscope_; }
    [[nodiscard]] const std::optional<RigidTransform>& tube() const { return tube_; }
    [[nodiscard]] const std::optional<RigidTransform>& eye() const { return eye_; }
    [[nodiscard]] bool suction() const { return suction_; }
    [[nodiscard]] std::vector<ReceivedCommand> take_commands();
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

  private:
    void latch(const msg::Pose& pose, std::optional<RigidTransform>& to);

    bus::Subscriber<msg::ToolPose> laryngoscope_topic_, tube_topic_;
    bus::Subscriber<msg::EyePose> eye_topic_;
    bus::Subscriber<msg::Command> command_topic_;
    msg::ToolPose tool_;
    msg::EyePose eye_message_;
    msg::Command command_;
    std::optional<RigidTransform> laryngoscope_, tube_, eye_;
    bool suction_ = false;
    std::vector<ReceivedCommand> commands_;
    std::uint64_t refused_ = 0;
};

}  // namespace eti::app
