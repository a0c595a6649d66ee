// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/bus/bus.hpp"

namespace eti::bus {

inline constexpr std::uint16_t discovery_port = 11811;

/// The library's discovery server behind this project's receive filter. It tells programs that connect to its
/// address about each other. Throws BusError.
class DiscoveryServer {
  public:
    /// `number`: index in the list given to programs, 0 to 255. `address`: local address to listen on; empty:
    /// all. Of `options` only name and domain are used; secured programs cannot use a discovery server.
    DiscoveryServer(const Options& options, int number, const std::string& address, std::uint16_t port);
    ~DiscoveryServer();
    DiscoveryServer(const DiscoveryServer&) = delete;
    DiscoveryServer& operator=(const DiscoveryServer&) = delete;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace eti::bus
