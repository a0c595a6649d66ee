// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "deploy/doctor/finding.hpp"

namespace eti::doctor {

/// A network interface with an IPv4 address.
struct Interface {
    std::string name;
    std::string address;
    bool up = false;
    bool loopback = false;
    bool multicast = false;          ///< according to its flag
    int mtu = 0;                     ///< [bytes]
    bool multicast_returns = false;  ///< a datagram sent through it to a group came back
};

/// The interfaces of this machine, each tested with a datagram to a multicast group.
[[nodiscard]] std::vector<Interface> interfaces();

/// `reaches_network`: the session uses other hosts, found by multicast if `by_multicast`.
[[nodiscard]] Findings diagnose_interfaces(const std::vector<Interface>& all, bool reaches_network,
                                           bool by_multicast);

/// Maximum socket buffers that the kernel grants [bytes]; negative: unknown.
struct SocketBuffers {
    long receive = -1;
    long send = -1;
};

[[nodiscard]] SocketBuffers socket_buffers();
[[nodiscard]] Findings diagnose_buffers(const SocketBuffers& buffers);

}  // namespace eti::doctor
