// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "client/app/annotator.hpp"
#include "client/app/command_keys.hpp"
#include "client/app/selection.hpp"
#include "client/hands/drag.hpp"
#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/command_sender.hpp"

namespace eti::client {

/// Key and what it does, for help on the screen and on the command line; without the commands for one who
/// only watches. `marks`: for one who writes and draws.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> keys_help(bool commands, bool marks = false);

/// What keys and mouse do in a window: choose what is shown and from where, show help, give commands.
class Controls {
  public:
    using Time = CommandTyping::Time;

    /// `commands`: null for an observer, who gives none.
    Controls(const Selection& selection, bus::CommandSender* commands, const render::Vantage& vantage = {})
        : selection_(&selection), commands_(commands), vantage_(vantage) {}

    /// Who may write, point and draw.
    void annotate_with(Annotator& annotator) { annotator_ = &annotator; }
    /// Who is not the trainee may look through the trainee's eye; `at_first`: does so from the beginning.
    void watch_trainee(bool at_first) {
        watches_ = true;
        follows_ = at_first;
    }
    /// Brings what follows the scene up to date: the trainee's eye, where that is looked through.
    void follow(const view::SceneView& scene);
    /// Somebody writes: every key belongs to the text.
    [[nodiscard]] bool writing() const { return annotator_ != nullptr && annotator_->writing(); }
    /// While writing(). A character as typed, or one of special_keys.hpp.
    void type(char32_t key, Time now);

    /// A character in lower case, or an arrow. `repeated`: the key is held.
    void press(char32_t key, bool repeated, const view::SceneView& scene, Time now);
    void release(char32_t key, Time now);
    /// In a picture of `width` x `height` pixels.
    void drag(const Drag& mouse, const view::SceneView& scene, int width, int height, Time now = {});
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
    void draw_mark(const Drag& mouse, const view::SceneView& scene, int width, int height, Time now);

    const Selection* selection_;
    bus::CommandSender* commands_;
    render::Vantage vantage_;
    CommandTyping typing_;
    std::vector<bus::Refusal> refusals_;
    Annotator* annotator_ = nullptr;
    float marked_x_ = 0.0f, marked_y_ = 0.0f;  // [pixels] where a mark was last led
    bool watches_ = false, follows_ = false;
    std::optional<view::TraineeEye> own_eye_;  // meanwhile
    bool help_ = false;
    std::string notice_;
    Time notice_since_;
};

}  // namespace eti::client
