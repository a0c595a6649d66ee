// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/command_sender.hpp"
#include "common/bus/session_keys.hpp"
#include "devices/app/command_pad.hpp"

namespace eti::devices {

/// A command as a person types it, KEY=VALUE, e.g. "tongue_scale=1.2" or "table_angle_deg=-10". Throws
/// InputError naming the keys there are.
[[nodiscard]] PadCommand command_from(const std::string& typed);

/// The commands of a preset by name or path. Throws InputError naming those there are.
[[nodiscard]] std::vector<PadCommand> commands_of_preset(const std::string& name_or_path);

/// Sends commands to a session and takes the server's answers. For one thread.
class CommandLink {
  public:
    explicit CommandLink(const bus::Options& options);

    [[nodiscard]] bool served() const { return commands_.served(); }
    void send(const PadCommand& command);
    /// Reads what has come, and logs refusals. Throws bus::BusError while the session's server speaks another
    /// protocol.
    void poll();
    /// Waits for all answers, at most `patience`; true if they have come.
    [[nodiscard]] bool wait_for_answers(std::chrono::milliseconds patience);

    [[nodiscard]] std::uint32_t sent() const { return commands_.sent(); }
    [[nodiscard]] std::uint32_t accepted() const { return commands_.accepted(); }
    [[nodiscard]] std::uint32_t refused() const { return commands_.refused(); }
    [[nodiscard]] bool session_finished() const { return session_finished_; }
    /// What the session says of itself, once it has.
    [[nodiscard]] const std::optional<msg::SessionDescription>& description() const { return description_; }
    /// [SI], what lives as the server last said, in the order of the description; empty before.
    [[nodiscard]] const std::vector<float>& now() const { return now_; }
    /// What the server last said of the patient.
    [[nodiscard]] const std::optional<LiveValues>& patient() const { return patient_; }

  private:
    static void say_device(const char* tool, msg::DevicePresence now, msg::DevicePresence& said);

    bus::Node node_;
    bus::CommandSender commands_;
    bus::Subscriber<msg::SessionStatus> status_;
    bus::Subscriber<msg::SessionDescription> description_topic_;
    bus::Subscriber<msg::LiveMetrics> live_;
    std::optional<bus::SessionKeys> keys_;  // once the session has described itself
    std::optional<msg::SessionDescription> description_;
    std::vector<float> now_;  // in its order
    std::optional<LiveValues> patient_;
    bool session_finished_ = false;
    msg::DevicePresence laryngoscope_ = msg::DEVICE_NONE, tube_ = msg::DEVICE_NONE;  // as last said
};

}  // namespace eti::devices
