// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "client/app/session_panel.hpp"
#include "client/app/window/window.hpp"
#include "client/panel/panel_renderer.hpp"

namespace eti::client {

/// The instructor's panel in a window: a key toggles it beside the scene; it captures mouse and keys as
/// needed.
class WindowPanel {
  public:
    using Time = panel::Model::Time;

    /// `commands`: null for an observer, whose panel sends nothing. All arguments must outlive the panel.
    WindowPanel(Window& window, bus::Node& node, bus::CommandSender* commands, bool shown);

    /// Call instead of Window::poll_events().
    void poll_events();
    /// Returns true if the key belongs to the panel or toggles it, and must not be handled elsewhere.
    bool press(const KeyEvent& event);
    /// Whether the panel captures the mouse.
    [[nodiscard]] bool has_mouse() const { return shown_ && drawing_.has_mouse(); }
    /// Whether the panel captures the keyboard, including Esc.
    [[nodiscard]] bool has_keyboard() const { return shown_ && drawing_.has_keyboard(); }

    /// Takes in the server's state and sends the requested commands.
    void follow(const view::SceneView& scene, const SessionInput& input,
                std::span<const bus::Refusal> refusals, Time now) {
        session_.follow(scene, input, refusals, now);
    }
    /// The part of the window left for the scene.
    [[nodiscard]] panel::Area scene_area() const;
    /// Draws into the window, beside the scene.
    void draw(Time now);

  private:
    Window& window_;
    SessionPanel session_;
    panel::PanelRenderer drawing_;
    bool shown_;
};

}  // namespace eti::client
