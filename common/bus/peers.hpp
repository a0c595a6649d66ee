// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// A program of this project that a node has met on its domain, in whatever session.
struct Peer {
    std::string name;  ///< Options::name
    std::string session;
    std::string process;  ///< host:pid
    int protocol = 0;     ///< that it speaks; see bus::protocol
    bool serves = false;  ///< it writes the status of the node's session
    std::string version;  ///< of its program
    /// When it joined [ns, its system clock] and, to tell two of one instant apart, its identity.
    std::pair<std::uint64_t, ParticipantId> started;
};

/// Those that the node has met, by name and process.
[[nodiscard]] std::vector<Peer> met_programs(const Node& node);

}  // namespace eti::bus
