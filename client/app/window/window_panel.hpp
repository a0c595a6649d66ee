// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/app/window/window.hpp"
#include "client/panel/panel_renderer.hpp"

namespace eti::client {

/// The instructor's panel in a window: a key toggles it beside the scene; it captures mouse and keys as
/// needed.
class WindowPanel {
  public:
    using Time = panel::Model::Time;

    /// Window and model must outlive the panel.
    WindowPanel(Window& window, panel::Model& model, bool shown, float text_scale)
        : window_(window),
          model_(model),
          drawing_(window.handle(), text_scale),
          text_scale_(text_scale),
          shown_(shown) {}

    /// Call instead of Window::poll_events().
    void poll_events();
    /// Returns true if the key belongs to the panel or toggles it, and must not be handled elsewhere.
    bool press(const KeyEvent& event);
    /// Whether the panel captures the mouse.
    [[nodiscard]] bool has_mouse() const { return shown_ && drawing_.has_mouse(); }
    /// Whether the panel captures the keyboard, including Esc.
    [[nodiscard]] bool has_keyboard() const { return shown_ && drawing_.has_keyboard(); }

    /// The part of the window left for the scene.
    [[nodiscard]] panel::Area scene_area() const;
    /// Draws into the window, beside the scene.
    void draw(Time now);

  private:
    Window& window_;
    panel::Model& model_;
    panel::PanelRenderer drawing_;
    float text_scale_;
    bool shown_;
};

}  // namespace eti::client
