// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/discovery/peers.hpp"

#include <algorithm>
#include <tuple>

#include "common/bus/participant.hpp"

namespace eti::bus {

std::vector<Peer> discovered_peers(const Node& node) {
    std::vector<Peer> met = node.impl().participant->peers();
    std::ranges::sort(met, {}, [](const Peer& one) { return std::tie(one.name, one.process); });
    return met;
}

Rediscoveries rediscoveries(const Node& node) {
    return node.impl().participant->rediscoveries();
}

}  // namespace eti::bus
