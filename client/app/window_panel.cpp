// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window_panel.hpp"

#include <epoxy/gl.h>

#include <fmt/format.h>

#include "client/app/command_keys.hpp"
#include "common/bus/peers.hpp"

namespace eti::client {
namespace {

using namespace std::chrono_literals;

constexpr auto between_looks = 1s;  // for who else is there

panel::Model::Send send_by(bus::CommandSender* commands) {
    if (commands == nullptr) {
        return {};
    }
    return [commands](std::string_view name, float value) { return commands->send(name, value); };
}

}  // namespace

WindowPanel::WindowPanel(Window& window, bus::Node& node, bus::CommandSender* commands, bool shown)
    : window_(window),
      node_(node),
      commands_(commands),
      drawing_(window.handle()),
      model_(send_by(commands), commands != nullptr ? load_presets() : Presets{}),
      shown_(shown) {}

void WindowPanel::poll_events() {
    const auto listening = drawing_.listen();
    window_.poll_events();
    if (!shown_) {
        drawing_.forget_input();
    }
}

bool WindowPanel::press(const KeyEvent& event) {
    if (!event.down) {
        return false;  // who saw it go down sees it come up
    }
    const bool typing = shown_ && drawing_.has_text();
    if (event.key == key_f1 || (event.key == U'p' && !typing)) {
        if (!event.repeated) {
            shown_ = !shown_;
            drawing_.take_keyboard();
        }
        return true;
    }
    return has_keyboard();
}

void WindowPanel::follow(const view::SceneView& scene, const SessionInput& input,
                         std::span<const bus::Refusal> refusals, Time now) {
    const Arrival& arrival = input.arrival();
    connection_.state_age_mean_ms = arrival.mean_ms();
    connection_.state_age_max_ms = arrival.most_ms();
    connection_.states = arrival.count();
    connection_.states_missed = arrival.missed();
    if (commands_ != nullptr) {
        connection_.sent = commands_->sent();
        connection_.accepted = commands_->accepted();
        connection_.refused = commands_->refused();
    }
    note_programs(now);
    model_.follow(scene, connection_, now);
    model_.hear(refusals);
    model_.tend(now);
}

void WindowPanel::note_programs(Time now) {
    if (now - programs_noted_ < between_looks) {
        return;
    }
    programs_noted_ = now;
    connection_.contested = node_.contested();
    connection_.programs.clear();
    for (const bus::Peer& peer : bus::met_programs(node_)) {
        if (peer.session == node_.options().session) {
            connection_.programs.push_back(fmt::format("{} {}", peer.name, peer.process));
        }
    }
}

panel::Area WindowPanel::scene_area() const {
    return shown_ ? panel::scene_area(window_.width(), window_.height())
                  : panel::Area{0, 0, window_.width(), window_.height()};
}

void WindowPanel::draw(Time now) {
    if (!shown_) {
        return;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_.width(), window_.height());
    drawing_.draw(model_, window_.width(), window_.height(), now);
}

}  // namespace eti::client
