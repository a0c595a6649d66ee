// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "common/process/files/descriptor.hpp"

namespace eti::bus {

/// IPv4 addresses of the interfaces that are up, loopback excluded, as "eth0 192.0.2.1"; sorted.
[[nodiscard]] std::vector<std::string> network_addresses();

/// Calls `added` on its own thread when an address of network_addresses() is there for the first time: a
/// cable was plugged in, or an interface got its address after the program had started. Uses the kernel's
/// messages about interfaces (rtnetlink(7)); where there are none, it never calls.
class InterfaceWatcher {
  public:
    /// Changes within this time are reported together.
    static constexpr std::chrono::milliseconds settling_time{200};

    explicit InterfaceWatcher(std::function<void(const std::string& addresses)> added);
    ~InterfaceWatcher();
    InterfaceWatcher(const InterfaceWatcher&) = delete;
    InterfaceWatcher& operator=(const InterfaceWatcher&) = delete;

  private:
    void run();

    std::function<void(const std::string&)> added_;
    Descriptor kernel_, end_;
    std::vector<std::string> known_;  // all that have been there
    std::thread thread_;
};

}  // namespace eti::bus
