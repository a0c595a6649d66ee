// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace eti::bus {

/// Keeps a program to one network interface. Binding its sockets to the interface's address is not enough:
/// the kernel delivers datagrams for that address, and those of a multicast group, from every interface
/// (ip(7), IP_MULTICAST_ALL), and routes what is sent to announced addresses through whichever interface
/// leads there. Thread-safe.
class InterfaceGuard {
  public:
    using Clock = std::chrono::steady_clock;
    using Address = std::array<std::uint8_t, 4>;

    /// `own`: the interface's IPv4 addresses, in dotted notation.
    explicit InterfaceGuard(const std::vector<std::string>& own);

    /// Whether the kernel's way to an address leads through the interface, or stays within this machine's
    /// loopback: strict reverse path filtering (RFC 3704), without changing the machine's settings.
    [[nodiscard]] bool leads_to(const Address& other, Clock::time_point now = Clock::now());

    /// For which an answer is kept; routes change when interfaces come and go.
    static constexpr std::chrono::seconds kept_for{10};
    /// Beyond this number, all answers are forgotten.
    static constexpr std::size_t max_answers = 256;

  private:
    struct Answer {
        bool leads = false;
        Clock::time_point until;
    };
    std::vector<Address> own_;
    std::mutex mutex_;
    std::map<Address, Answer> answers_;
};

}  // namespace eti::bus
