// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/app/session_input.hpp"
#include "client/panel/model.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/command_sender.hpp"

namespace eti::client {

/// The instructor's panel of a client's session, without its renderer.
class SessionPanel {
  public:
    using Time = panel::Model::Time;

    /// `commands`: null for an observer, whose panel sends nothing. All arguments must outlive the panel.
    SessionPanel(bus::Node& node, bus::CommandSender* commands);

    /// Takes in the server's state and sends the requested commands.
    void follow(const view::SceneView& scene, const SessionInput& input,
                std::span<const bus::Refusal> refusals, Time now);
    [[nodiscard]] panel::Model& model() { return model_; }

  private:
    void note_programs(Time now);

    bus::Node& node_;
    bus::CommandSender* commands_;
    panel::Model model_;
    panel::Connection connection_;
    Time programs_noted_{};
};

}  // namespace eti::client
