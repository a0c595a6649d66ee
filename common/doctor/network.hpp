// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "common/doctor/finding.hpp"

namespace eti::doctor {

/// A network interface with an IPv4 address.
struct Interface {
    std::string name;
    std::string address;
    bool up = false;
    bool loopback = false;
    bool multicast = false;          ///< its flag says so
    int mtu = 0;                     ///< [bytes]
    bool multicast_returns = false;  ///< a datagram sent to a group through it came back
};

/// Those of this machine, each tried with a datagram to a multicast group.
[[nodiscard]] std::vector<Interface> interfaces();

/// `reaches_network`: the session asks for other machines, found by multicast where `by_multicast`.
[[nodiscard]] Findings judge_interfaces(const std::vector<Interface>& all, bool reaches_network,
                                        bool by_multicast);

/// What the kernel lets a socket have at most [bytes]; negative: unknown.
struct SocketBuffers {
    long receive = -1;
    long send = -1;
};

[[nodiscard]] SocketBuffers socket_buffers();
[[nodiscard]] Findings judge_buffers(const SocketBuffers& buffers);

}  // namespace eti::doctor
