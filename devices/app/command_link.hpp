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
#include "common/bus/security/session_keys.hpp"
#include "devices/app/command_pad.hpp"

namespace eti::devices {

/// Parses a command typed as KEY=VALUE, such as "tongue_scale=1.2" or "table_angle_deg=-10". Throws
/// InputError naming the available keys.
[[nodiscard]] PadCommand command_from(const std::string& typed);

/// The commands of a preset by name or path. Throws InputError naming the available presets.
[[nodiscard]] std::vector<PadCommand> commands_of_preset(const std::string& name_or_path);

/// Sends commands to a session and receives the server's answers; use from one thread.
class CommandLink {
  public:
    explicit CommandLink(const bus::Options& options);

    [[nodiscard]] bool has_server() const { return commands_.has_server(); }
    void send(const PadCommand& command);
    /// Reads new messages and logs rejected commands. Throws bus::BusError while the session's server speaks
    /// another protocol.
    void poll();
    /// Waits up to `timeout` for all answers; true if all have arrived.
    [[nodiscard]] bool wait_for_answers(std::chrono::milliseconds timeout);

    [[nodiscard]] std::uint32_t sent() const { return commands_.sent(); }
    [[nodiscard]] std::uint32_t accepted() const { return commands_.accepted(); }
    [[nodiscard]] std::uint32_t refused() const { return commands_.refused(); }
    [[nodiscard]] bool session_finished() const { return session_finished_; }
    /// The session's description, once received.
    [[nodiscard]] const std::optional<msg::SessionDescription>& description() const { return description_; }
    /// [SI], the latest runtime parameters from the server, in the order of the description; empty before.
    [[nodiscard]] const std::vector<float>& now() const { return now_; }
    /// The patient's runtime parameters as last reported by the server.
    [[nodiscard]] const std::optional<RuntimeParameters>& patient() const { return patient_; }

  private:
    static void log_device_change(const char* tool, msg::DevicePresence now, msg::DevicePresence& said);

    bus::Node node_;
    bus::CommandSender commands_;
    bus::Subscriber<msg::SessionStatus> status_;
    bus::Subscriber<msg::SessionDescription> description_topic_;
    bus::Subscriber<msg::LiveMetrics> live_;
    std::optional<bus::SessionKeys> keys_;  // once the description has arrived
    std::optional<msg::SessionDescription> description_;
    std::vector<float> now_;  // in the description's order
    std::optional<RuntimeParameters> patient_;
    bool session_finished_ = false;
    msg::DevicePresence laryngoscope_ = msg::DEVICE_NONE, tube_ = msg::DEVICE_NONE;  // as last reported
};

}  // namespace eti::devices
