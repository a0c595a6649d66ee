// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "common/process/descriptor.hpp"

namespace eti {

/// Tells the service manager how a program is, by the protocol of sd_notify(3): one datagram of text to the
/// socket that NOTIFY_SOCKET names. Without that variable it does nothing. Never waits for the manager: what
/// does not fit into its socket is left out. From one thread.
class ServiceNotify {
  public:
    ServiceNotify();

    /// The program does its work, and has just done a piece of it. The first call says that it is ready,
    /// later ones that it is alive, four times in the span in which the manager wants to hear of it. Cheap:
    /// call it from the loop that must not hang, and from nowhere else.
    void alive();

    /// A line for whoever asks the manager.
    void say(std::string_view status) { send("STATUS=" + std::string(status)); }

    /// The program is about to end.
    void ending() { send("STOPPING=1"); }

  private:
    using Time = std::chrono::steady_clock;
    void send(const std::string& text);

    Descriptor socket_;  // none: nobody listens
    std::string address_;
    std::optional<Time::duration> interval_;  // none: no watchdog
    Time::time_point next_;
    bool ready_ = false;
};

}  // namespace eti
