// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/client_session.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <string>

#include <fmt/format.h>

#include "client/app/session_sound.hpp"
#include "common/bus/discovery/peers.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;

constexpr auto peer_poll_interval = 1s;  // for the list of programs on the bus
constexpr auto annotation_delivery_wait = 500ms;
// Pictures wait for a slow server; a viewer is told at once.
constexpr double silent_for_s = 15.0;

}  // namespace

ClientSession::ClientSession(const Options& options)
    : node(options.bus),
      input(node, options.full_rate(), options.is_trainee(),
            options.interactive() ? SessionInput::Timing::newest : SessionInput::Timing::moments),
      controls(*options.selection,
               options.sends_commands() ? &commands.emplace(node, options.bus.name) : nullptr,
               options.vantage),
      options_(options) {
    if (options.hands) {
        hands.emplace(node, options.play, options.tutorial);
    }
    if (!options.is_trainee() && !options.headset) {
        controls.allow_trainee_view(options.instructor);
    }
    if (!options.interactive()) {
        return;
    }
    if (options.instructor) {
        annotations_.emplace(node, bus::topics::annotation);
        annotator_.emplace(bus::process_name().substr(0, msg::bound::Annotation_sender),
                           [this](const msg::Annotation& annotation) {
                               return annotations_->matched() > 0 && annotations_->publish(annotation);
                           });
        controls.set_annotator(*annotator_);
    }
    if (commands) {
        panel.emplace([this](std::string_view name, float value) { return commands->send(name, value); },
                      load_presets());
    } else {
        panel.emplace(panel::Model::Send());
    }
    sound_ = session_sound(options.sound, options.volume);
}

void ClientSession::receive() {
    input.receive_into(scene);
    if (input.lost(options_.interactive() ? lost_after_s : silent_for_s) != lost) {
        lost = !lost;
        spdlog::warn(!lost                    ? "connected to a server again"
                     : options_.interactive() ? "connection to the server lost; waiting for a server"
                                              : "connection to the server lost; keeping the last picture");
    }
    if (!scene.complete() || lost) {
        bus::refuse_other_protocol(node);
    }
}

void ClientSession::key(const KeyEvent& event, Time now) {
    if (event.down && controls.writing()) {
        controls.type(event.typed != 0 ? event.typed : event.key, now);
    } else if (!hands || !hands->key(event)) {
        event.down ? controls.press(event.key, event.repeated, scene, now) : controls.release(event.key, now);
    }
}

void ClientSession::drag(const hands::Drag& mouse, int width, int height, Time now) {
    if (!hands || !hands->drag(mouse, controls, scene, width, height)) {
        controls.drag(mouse, scene, width, height, now);
    }
}

bool ClientSession::update(Time now) {
    controls.follow(scene);
    controls.update(now);
    if (panel) {
        update_panel(now);
    }
    if (sound_) {
        sound_->set_cue(cue_of(scene, lost));
    }
    return hands && hands->update(scene, selection());
}

void ClientSession::update_panel(Time now) {
    const ArrivalStatistics& arrival = input.arrival();
    connection_.state_age_mean_ms = arrival.mean_ms();
    connection_.state_age_max_ms = arrival.max_ms();
    connection_.states = arrival.count();
    connection_.states_missed = arrival.missed();
    if (commands) {
        connection_.sent = commands->sent();
        connection_.accepted = commands->accepted();
        connection_.refused = commands->refused();
    }
    if (now - programs_noted_ >= peer_poll_interval) {
        programs_noted_ = now;
        connection_.contested = node.contested();
        connection_.programs.clear();
        for (const bus::Peer& peer : bus::discovered_peers(node)) {
            if (peer.session == node.options().session) {
                connection_.programs.push_back(fmt::format("{} {}", peer.name, peer.process));
            }
        }
    }
    panel->follow(scene, connection_, now);
    panel->note_refusals(controls.refusals());
    panel->update(now);
}

void ClientSession::finish() {
    controls.release_all_keys(std::chrono::steady_clock::now());
    if (annotations_) {
        annotations_->wait_until_received(annotation_delivery_wait);
    }
}

const Selection& ClientSession::selection() const {
    return hands ? hands->shown(controls.selection()) : controls.selection();
}

hud::Readout ClientSession::readout(Time now) const {
    hud::Readout out = hud::make_readout(scene, lost, node.contested());
    if (hands) {
        hands->add_to(out);
    }
    controls.add_to(out, now);
    if (hands && !out.keys.empty()) {
        out.keys = HandControls::help();
    }
    return out;
}

nlohmann::json ClientSession::report(std::string_view end, std::uint64_t frames) {
    nlohmann::json out{
        {"session", options_.bus.session},
        {"view", std::string(controls.selection().name)},
        {"scenarios", input.scenarios()},
        {"end", std::string(end)},
        {"simulation_time_s", 1e-9 * static_cast<double>(scene.simulation_time_ns())},
        {"frames", frames},
        {"messages_dropped", scene.dropped()},
        {"states_missed", input.arrival().missed()},
        {"state_age_ms", {{"mean", input.arrival().mean_ms()}, {"max", input.arrival().max_ms()}}}};
    if (hands) {
        out["hands"] = hands->report();
    }
    if (commands) {
        (void)commands->take_answers();
        out["commands"] = {
            {"sent", commands->sent()}, {"accepted", commands->accepted()}, {"refused", commands->refused()}};
    }
    return out;
}

}  // namespace eti::client
