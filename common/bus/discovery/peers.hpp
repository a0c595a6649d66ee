// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// A program of this project that a node has discovered on its domain, in any session.
struct Peer {
    std::string name;  ///< Options::name
    std::string session;
    std::string process;  ///< host:pid
    int protocol = 0;     ///< its protocol version; see bus::protocol
    bool serves = false;  ///< it publishes the status of the node's session
    std::string version;  ///< of its program
    /// Start time [ns, its system clock] and, to break ties, its identifier.
    std::pair<std::uint64_t, ParticipantId> started;
};

/// How often participants and writers were discovered again under an identifier that had gone. No program
/// does so by itself: one that starts again has a new identifier.
struct Rediscoveries {
    std::uint64_t after_departure = 0;  ///< a departure was announced (a dispose), which was false
    std::uint64_t after_silence = 0;    ///< it had not been heard for the lease duration
};

/// As of now, in all sessions of the domain.
[[nodiscard]] Rediscoveries rediscoveries(const Node& node);

/// Peers that the node has discovered, by name and process.
[[nodiscard]] std::vector<Peer> discovered_peers(const Node& node);

}  // namespace eti::bus
