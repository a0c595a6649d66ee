// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "client/app/command_keys.hpp"
#include "client/app/selection.hpp"
#include "client/hands/drag.hpp"
#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/command_sender.hpp"

namespace eti::client {

/// Key and what it does, for help on the screen and on the command line; without the commands for one who
/// only watches.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> keys_help(bool commands);

/// What keys and mouse do in a window: choose what is shown and from where, show help, give commands.
class Controls {
  public:
    using Time = CommandTyping::Time;

    /// `commands`: null for an observer, who gives none.
    Controls(const Selection& selection, bus::CommandSender* commands, const render::Vantage& vantage = {})
        : selection_(&selection), commands_(commands), vantage_(vantage) {}

    /// A character in lower case, or an arrow. `repeated`: the key is held.
    void press(char32_t key, bool repeated, const view::SceneView& scene, Time now);
    void release(char32_t key, Time now);
    /// In a picture of `width` x `height` pixels.
    void drag(const Drag& mouse, const view::SceneView& scene, int width, int height);
    /// Takes the server's answers.
    void tend(Time now);
    /// What the server refused, as of the last tend().
    [[nodiscard]] std::span<const bus::Refusal> refusals() const { return refusals_; }
    /// Lets go of every key, as when the window closes: nothing stays on that was on while held.
    void let_go(Time now);

    [[nodiscard]] const Selection& selection() const { return *selection_; }
    [[nodiscard]] const render::Vantage& vantage() const { return vantage_; }
    /// Adds help and notices to what is shown.
    void put_into(hud::Readout& readout, Time now) const;

  private:
    void send(const std::optional<WantedCommand>& command, Time now);
    void say(std::string text, Time now);

    const Selection* selection_;
    bus::CommandSender* commands_;
    render::Vantage vantage_;
    CommandTyping typing_;
    std::vector<bus::Refusal> refusals_;
    bool help_ = false;
    std::string notice_;
    Time notice_since_;
};

}  // namespace eti::client
