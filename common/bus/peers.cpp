// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/peers.hpp"

#include <algorithm>
#include <tuple>

#include "common/bus/participant.hpp"

namespace eti::bus {

std::vector<MetProgram> met_programs(const Node& node) {
    std::vector<MetProgram> met;
    for (const Peer& peer : node.impl().participant->peers()) {
        met.push_back({peer.name, peer.session, peer.process, peer.protocol, peer.version, peer.serves});
    }
    std::ranges::sort(met, {}, [](const MetProgram& one) { return std::tie(one.name, one.process); });
    return met;
}

}  // namespace eti::bus
