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

/// A command that the server did not carry out, and why.
struct Refusal {
    std::string name;  ///< of the command
    std::string reason;
};

/// Sends commands to a session and takes the server's answers. For one thread.
class CommandSender {
  public:
    /// `program`: who sends, as the server logs it; the process's number is added.
    CommandSender(Node& node, std::string_view program);

    /// `value`: SI. False: no server takes commands now.
    bool send(std::string_view name, float value);
    /// Waits until there is an answer to read.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout) { return answers_.wait(timeout); }
    /// Reads what has come: the refusals since the last call, which are also logged.
    [[nodiscard]] std::vector<Refusal> take_answers();

    /// Before the sender goes: a writer takes with it what was not delivered.
    void wait_until_received(std::chrono::milliseconds timeout) {
        (void)commands_.wait_until_received(timeout);
    }

    /// A server takes commands.
    [[nodiscard]] bool served() const { return commands_.matched() > 0; }
    [[nodiscard]] std::uint32_t sent() const { return sent_; }
    [[nodiscard]] std::uint32_t accepted() const { return accepted_; }
    [[nodiscard]] std::uint32_t refused() const { return refused_; }

  private:
    std::string sender_;
    Publisher<msg::Command> commands_;
    Subscriber<msg::CommandResult> answers_;
    std::map<std::uint32_t, std::string> unanswered_;  // names by number
    std::uint32_t sent_ = 0, accepted_ = 0, refused_ = 0;
};

}  // namespace eti::bus
