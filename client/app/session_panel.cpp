// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_panel.hpp"

#include <fmt/format.h>

#include "common/bus/peers.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;

constexpr auto peer_poll_interval = 1s;  // for the list of programs on the bus

panel::Model::Send send_by(bus::CommandSender* commands) {
    if (commands == nullptr) {
        return {};
    }
    return [commands](std::string_view name, float value) { return commands->send(name, value); };
}

}  // namespace

SessionPanel::SessionPanel(bus::Node& node, bus::CommandSender* commands)
    : node_(node),
      commands_(commands),
      model_(send_by(commands), commands != nullptr ? load_presets() : Presets{}) {}

void SessionPanel::follow(const view::SceneView& scene, const SessionInput& input,
                          std::span<const bus::Refusal> refusals, Time now) {
    const ArrivalStatistics& arrival = input.arrival();
    connection_.state_age_mean_ms = arrival.mean_ms();
    connection_.state_age_max_ms = arrival.max_ms();
    connection_.states = arrival.count();
    connection_.states_missed = arrival.missed();
    if (commands_ != nullptr) {
        connection_.sent = commands_->sent();
        connection_.accepted = commands_->accepted();
        connection_.refused = commands_->refused();
    }
    note_programs(now);
    model_.follow(scene, connection_, now);
    model_.note_refusals(refusals);
    model_.update(now);
}

void SessionPanel::note_programs(Time now) {
    if (now - programs_noted_ < peer_poll_interval) {
        return;
    }
    programs_noted_ = now;
    connection_.contested = node_.contested();
    connection_.programs.clear();
    for (const bus::Peer& peer : bus::discovered_peers(node_)) {
        if (peer.session == node_.options().session) {
            connection_.programs.push_back(fmt::format("{} {}", peer.name, peer.process));
        }
    }
}

}  // namespace eti::client
