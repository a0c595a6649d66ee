// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "client/app/selection.hpp"
#include "client/render/camera.hpp"

struct GLFWwindow;

namespace eti::client {

/// A window with an OpenGL 3.3 context, which is current. Keys choose the view, the mouse turns
/// the overview and its wheel moves it nearer, Esc closes.
class Window {
  public:
    /// Throws std::runtime_error where there is no display, naming --offscreen as the remedy.
    Window(int width, int height, const std::string& title, const Selection& selection);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    [[nodiscard]] bool open() const;
    void poll_events();
    void show_frame();

    /// Size of the drawing area in pixels, at least 64 a side.
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    [[nodiscard]] const Selection& selection() const { return *selection_; }
    [[nodiscard]] const render::Orbit& orbit() const { return orbit_; }

  private:
    void on_key(int key);
    void on_character(unsigned character);
    void on_drag(double x, double y);

    GLFWwindow* window_ = nullptr;
    const Selection* selection_;
    render::Orbit orbit_;
    double last_x_ = 0.0, last_y_ = 0.0;
    bool dragging_ = false;
};

}  // namespace eti::client
