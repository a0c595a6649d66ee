// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "common/process/files/descriptor.hpp"

namespace eti {

/// Reports a program's state to the service manager by the protocol of sd_notify(3): one text datagram to the
/// socket in NOTIFY_SOCKET. Does nothing without that variable. Never blocks: what does not fit into the
/// socket is dropped. Use from one thread.
class ServiceNotify {
  public:
    ServiceNotify();

    /// Reports progress. The first call reports readiness, later ones feed the manager's watchdog four times
    /// per watchdog interval. Cheap: call it from the loop that must not hang, and from nowhere else.
    void alive();

    /// Status line shown by the service manager.
    void say(std::string_view status) { send("STATUS=" + std::string(status)); }

    /// Reports that the program is about to end.
    void ending() { send("STOPPING=1"); }

  private:
    using Time = std::chrono::steady_clock;
    void send(const std::string& text);

    Descriptor socket_;  // none: no manager
    std::string address_;
    std::optional<Time::duration> interval_;  // none: no watchdog
    Time::time_point next_;
    bool ready_ = false;
};

}  // namespace eti
