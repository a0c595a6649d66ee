// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/app/session_panel.hpp"
#include "client/app/window.hpp"
#include "client/panel/drawing.hpp"

namespace eti::client {

/// The instructor's panel in a window: a key shows it beside the scene, mouse and keys are its own where it
/// wants them.
class WindowPanel {
  public:
    using Time = panel::Model::Time;

    /// `commands`: null for an observer, whose panel sends nothing. All have to outlive it.
    WindowPanel(Window& window, bus::Node& node, bus::CommandSender* commands, bool shown);

    /// In place of the window's own.
    void poll_events();
    /// Whether a key is the panel's, or shows or hides it, and so nothing to anybody else.
    bool press(const KeyEvent& event);
    /// What the mouse did is the panel's.
    [[nodiscard]] bool has_mouse() const { return shown_ && drawing_.has_mouse(); }
    /// Keys are the panel's, Esc among them.
    [[nodiscard]] bool has_keyboard() const { return shown_ && drawing_.has_keyboard(); }

    /// Takes in what the server says, and sends what was asked for.
    void follow(const view::SceneView& scene, const SessionInput& input,
                std::span<const bus::Refusal> refusals, Time now) {
        session_.follow(scene, input, refusals, now);
    }
    /// Of the window, what is left to the scene.
    [[nodiscard]] panel::Area scene_area() const;
    /// Into the window, beside the scene.
    void draw(Time now);

  private:
    Window& window_;
    SessionPanel session_;
    panel::Drawing drawing_;
    bool shown_;
};

}  // namespace eti::client
