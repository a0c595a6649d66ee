// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/hands/drag.hpp"

struct GLFWwindow;

namespace eti::client {

/// A key went down or up: a character in lower case, or one of special_keys.hpp.
struct KeyEvent {
    char32_t key;
    bool down;
    bool repeated;
    char32_t typed = 0;  ///< with its case
};

/// A window with an OpenGL 3.3 context, which is current. Esc closes; other keys and what the mouse did wait
/// to be taken.
class Window {
  public:
    /// Throws std::runtime_error where there is no display, naming --offscreen as the remedy.
    Window(int width, int height, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    [[nodiscard]] bool open() const;
    /// Nobody sees what would be drawn.
    [[nodiscard]] bool minimised() const;
    void poll_events();
    /// Esc is somebody else's, and does not close.
    void keep_escape(bool keep) { escape_kept_ = keep; }
    [[nodiscard]] GLFWwindow* handle() const { return window_; }
    /// Shows frames as they come, where something else sets the pace.
    void show_at_once();
    void show_frame();

    /// Size of the drawing area in pixels, at least 64 a side.
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// What happened to the keys since the last call, oldest first.
    [[nodiscard]] std::vector<KeyEvent> take_keys() { return std::exchange(keys_, {}); }
    /// The same of the mouse.
    [[nodiscard]] std::vector<Drag> take_drags() { return std::exchange(drags_, {}); }

  private:
    void on_key(int key, int scancode, int action);
    void on_character(unsigned character);
    void on_button(int button, int action, int modifiers);
    void on_move(double x, double y);
    void on_wheel(double notches);
    /// With where the mouse is now.
    void push_drag(const Drag& drag);
    /// In pixels of the drawing area: a window's own units may be larger.
    [[nodiscard]] double pixels_per_unit() const;
    [[nodiscard]] bool shift_down() const;

    GLFWwindow* window_ = nullptr;
    std::vector<KeyEvent> keys_;
    bool repeating_ = false, escape_kept_ = false;
    std::vector<Drag> drags_;
    double last_x_ = 0.0, last_y_ = 0.0;
    int held_ = -1;  ///< mouse button, or none
    Drag begun_;     ///< where that went down
};

}  // namespace eti::client
