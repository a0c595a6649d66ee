// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "client/render/camera.hpp"

struct GLFWwindow;

namespace eti::client {

/// A key went down or up: a character in lower case, or an arrow of command_keys.hpp.
struct KeyEvent {
    char32_t key;
    bool down;
    bool repeated;
};

/// A window with an OpenGL 3.3 context, which is current. The mouse turns the overview and its wheel moves it
/// nearer, Esc closes; other keys wait to be taken.
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
    void show_frame();

    /// Size of the drawing area in pixels, at least 64 a side.
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    /// What happened to the keys since the last call, oldest first.
    [[nodiscard]] std::vector<KeyEvent> take_keys() { return std::exchange(keys_, {}); }
    [[nodiscard]] const render::Orbit& orbit() const { return orbit_; }

  private:
    void on_key(int key, int scancode, int action);
    void on_character(unsigned character);
    void on_drag(double x, double y);

    GLFWwindow* window_ = nullptr;
    std::vector<KeyEvent> keys_;
    bool repeating_ = false;
    render::Orbit orbit_;
    double last_x_ = 0.0, last_y_ = 0.0;
    bool dragging_ = false;
};

}  // namespace eti::client
