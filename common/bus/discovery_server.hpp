// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"

namespace eti::bus {

inline constexpr std::uint16_t discovery_port = 11811;

/// The library's discovery server behind this project's receive filter: tells programs that were given its
/// address who else is there. Throws BusError.
class DiscoveryServer {
  public:
    /// `number`: its place in the list that programs are given, 0 to 255. `address`: of this machine, on
    /// which it listens; empty: on all. Of `options`: name and domain; secured programs do not meet by a
    /// discovery server.
    DiscoveryServer(const Options& options, int number, const std::string& address, std::uint16_t port);
    ~DiscoveryServer();
    DiscoveryServer(const DiscoveryServer&) = delete;
    DiscoveryServer& operator=(const DiscoveryServer&) = delete;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::bus
