// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "client/app/annotator.hpp"
#include "client/app/controls.hpp"
#include "client/app/options.hpp"
#include "client/app/session_input.hpp"
#include "client/app/window/hand_controls.hpp"
#include "client/panel/model.hpp"
#include "client/sound/player.hpp"

namespace eti::client {

/// A client's side of a session without its pictures: the same for a window, a headset and offscreen
/// drawing. A front end adds where input comes from and where pictures go. It calls, once per frame and in
/// this order: receive(), key() and drag(), update(), scene.update(), and draws with readout().
class ClientSession {
  public:
    using Time = Controls::Time;

    /// Throws BusError or InputError.
    explicit ClientSession(const Options& options);

    /// Applies all messages received.
    void receive();
    void key(const KeyEvent& event, Time now);
    /// A mouse drag in a picture of `width` x `height` pixels.
    void drag(const hands::Drag& mouse, int width, int height, Time now);
    /// Passes the scene and the server's replies to controls, panel, hands and sound. Returns true when the
    /// tutorial's next lesson begins.
    bool update(Time now);
    /// Releases every key, and waits until the server has received what was sent last.
    void finish();

    /// The views to show.
    [[nodiscard]] const Selection& selection() const;
    [[nodiscard]] hud::Readout readout(Time now) const;
    /// For --json; a front end adds what only it knows. `end`: why it ended.
    [[nodiscard]] nlohmann::json report(std::string_view end, std::uint64_t frames);

    bus::Node node;
    SessionInput input;
    view::SceneView scene;
    bool lost = false;                           ///< the server, as of the last receive()
    std::optional<bus::CommandSender> commands;  ///< none for an observer, or offscreen
    Controls controls;
    std::optional<HandControls> hands;  ///< with --hands
    std::optional<panel::Model> panel;  ///< none offscreen

  private:
    void update_panel(Time now);

    const Options& options_;
    std::optional<bus::Publisher<msg::Annotation>> annotations_;
    std::optional<Annotator> annotator_;  // an instructor's
    panel::Connection connection_;
    Time programs_noted_{};
    std::unique_ptr<sound::Player> sound_;
};

}  // namespace eti::client
