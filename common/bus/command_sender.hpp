// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// A command that the server rejected, and why.
struct Refusal {
    std::string name;  ///< of the command
    std::string reason;
};

/// Sends commands to a session and receives the server's answers; use from one thread.
class CommandSender {
  public:
    /// `program`: the sender's name in the server's log; the process id is appended.
    CommandSender(Node& node, std::string_view program);

    /// `value`: SI. False: no server accepts commands now.
    bool send(std::string_view name, float value);
    /// Waits until there is an answer to read.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout) { return answers_.wait(timeout); }
    /// Reads new answers and returns the rejected commands since the last call, which are also logged.
    [[nodiscard]] std::vector<Refusal> take_answers();

    /// Call before destruction, which discards undelivered commands.
    void wait_until_received(std::chrono::milliseconds timeout) {
        (void)commands_.wait_until_received(timeout);
    }

    /// Whether a server accepts commands.
    [[nodiscard]] bool has_server() const { return commands_.matched() > 0; }
    [[nodiscard]] std::uint32_t sent() const { return sent_; }
    [[nodiscard]] std::uint32_t accepted() const { return accepted_; }
    [[nodiscard]] std::uint32_t refused() const { return refused_; }

  private:
    std::string sender_;
    Publisher<msg::Command> commands_;
    Subscriber<msg::CommandResult> answers_;
    std::map<std::uint32_t, std::string> pending_;  // names by number
    std::uint32_t sent_ = 0, accepted_ = 0, refused_ = 0;
};

}  // namespace eti::bus
