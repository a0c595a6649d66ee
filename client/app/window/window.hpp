// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "client/hands/drag.hpp"

struct GLFWwindow;

namespace eti::client {

/// A key press or release: a lower-case character, or one of special_keys.hpp. A character without a function
/// is replaced by that of the same key on a US keyboard if it has one: Cyrillic layouts have no Latin
/// letters, and French ones no digits without shift.
struct KeyEvent {
    char32_t key;
    bool down;
    bool repeated;
    char32_t typed = 0;  ///< with its case
};

/// A window with a current OpenGL 3.3 context. Esc closes it; other key and mouse events are queued.
class Window {
  public:
    /// Throws std::runtime_error if there is no display, naming --offscreen as the remedy.
    Window(int width, int height, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    [[nodiscard]] bool open() const;
    /// Nothing drawn would be visible.
    [[nodiscard]] bool minimised() const;
    void poll_events();
    /// While set, Esc is delivered as a key and does not close the window.
    void intercept_escape(bool keep) { escape_intercepted_ = keep; }
    [[nodiscard]] GLFWwindow* handle() const { return window_; }
    /// Presents frames immediately, for use when something else paces the loop.
    void disable_vsync();
    void swap_buffers();

    /// Size of the drawing area in pixels, at least 64 per side.
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// Returns and clears the queued key events, oldest first.
    [[nodiscard]] std::vector<KeyEvent> take_keys() { return std::exchange(keys_, {}); }
    /// Returns and clears the queued mouse drags.
    [[nodiscard]] std::vector<hands::Drag> take_drags() { return std::exchange(drags_, {}); }

  private:
    void on_key(int key, int action);
    void on_character(unsigned character);
    void on_button(int button, int action, int modifiers);
    void on_move(double x, double y);
    void on_wheel(double notches);
    /// Queues a drag with the current mouse position.
    void push_drag(const hands::Drag& drag);
    /// Pixels of the drawing area per window coordinate; window coordinates may be larger than pixels.
    [[nodiscard]] double pixels_per_unit() const;
    [[nodiscard]] bool shift_down() const;

    GLFWwindow* window_ = nullptr;
    std::vector<KeyEvent> keys_;
    int last_key_ = -1;                ///< GLFW's code, by position, of the newest press
    std::map<int, char32_t> pressed_;  ///< by GLFW's code: as what its press was reported
    bool repeating_ = false, escape_intercepted_ = false;
    std::vector<hands::Drag> drags_;
    double last_x_ = 0.0, last_y_ = 0.0;
    int held_ = -1;           ///< mouse button, -1 if none
    hands::Drag drag_start_;  ///< position where it was pressed
};

}  // namespace eti::client
