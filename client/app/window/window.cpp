// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "client/app/controls.hpp"
#include "client/app/window/special_keys.hpp"
#include "client/hands/hands.hpp"

namespace eti::client {
namespace {

std::string last_glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "unknown";
}

char32_t lower(char32_t character) {
    return character >= U'A' && character <= U'Z' ? character + (U'a' - U'A') : character;
}

Window& window_of(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

}  // namespace

Window::Window(int width, int height, const std::string& title) {
    if (glfwInit() != GLFW_TRUE) {
        throw std::runtime_error(fmt::format(
            "cannot open a window ({}). Without a display use --offscreen DIR.", last_glfw_error()));
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    // Drivers report a reset only on request; the window system ignores the hint if unsupported.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string error = last_glfw_error();
        glfwTerminate();
        throw std::runtime_error(fmt::format(
            "cannot open a window with OpenGL 3.3 ({}). Install a driver, or use --offscreen DIR.", error));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(
        window_, [](GLFWwindow* w, int key, int, int action, int) { window_of(w).on_key(key, action); });
    // By character first, as key positions differ between keyboard layouts.
    glfwSetCharCallback(window_,
                        [](GLFWwindow* w, unsigned character) { window_of(w).on_character(character); });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int modifiers) {
        window_of(w).on_button(button, action, modifiers);
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { window_of(w).on_move(x, y); });
    glfwSetScrollCallback(window_,
                          [](GLFWwindow* w, double, double notches) { window_of(w).on_wheel(notches); });
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::open() const {
    return glfwWindowShouldClose(window_) == GLFW_FALSE;
}

void Window::poll_events() {
    glfwPollEvents();
}

void Window::disable_vsync() {
    glfwSwapInterval(0);
}

void Window::swap_buffers() {
    glfwSwapBuffers(window_);
}

int Window::width() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return std::max(width, 64);
}

bool Window::minimised() const {
    return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

int Window::height() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return std::max(height, 64);
}

void Window::on_key(int key, int action) {
    repeating_ = action == GLFW_REPEAT;
    if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS && !escape_intercepted_) {
        glfwSetWindowShouldClose(window_, GLFW_TRUE);
    }
    for (const auto& [code, silent] :
         {std::pair{GLFW_KEY_LEFT, key_left}, std::pair{GLFW_KEY_UP, key_up},
          std::pair{GLFW_KEY_RIGHT, key_right}, std::pair{GLFW_KEY_DOWN, key_down},
          std::pair{GLFW_KEY_ENTER, key_enter}, std::pair{GLFW_KEY_KP_ENTER, key_enter},
          std::pair{GLFW_KEY_BACKSPACE, key_backspace}, std::pair{GLFW_KEY_ESCAPE, key_escape},
          std::pair{GLFW_KEY_TAB, hands::other_hand_key}, std::pair{GLFW_KEY_F1, key_f1}}) {
        if (key == code) {
            keys_.push_back({silent, action != GLFW_RELEASE, repeating_});
        }
    }
    // Presses arrive in on_character(), releases only here.
    if (action != GLFW_RELEASE) {
        last_key_ = key;
    } else if (const auto pressed = pressed_.extract(key)) {
        keys_.push_back({pressed.mapped(), false, false});
    }
}

void Window::on_character(unsigned character) {
    const char32_t typed = lower(character);
    // GLFW's codes of printable keys are the characters of a US keyboard.
    const char32_t by_position =
        last_key_ > ' ' && last_key_ < 0x80 ? lower(static_cast<char32_t>(last_key_)) : char32_t{0};
    const bool replaced = !is_shortcut(typed) && is_shortcut(by_position);
    const char32_t key = replaced ? by_position : typed;
    pressed_[last_key_] = key;
    keys_.push_back({key, true, repeating_, character});
}

double Window::pixels_per_unit() const {
    int units = 0, height = 0;
    glfwGetWindowSize(window_, &units, &height);
    return units > 0 ? static_cast<double>(width()) / units : 1.0;
}

bool Window::shift_down() const {
    return glfwGetKey(window_, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
           glfwGetKey(window_, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
}

void Window::push_drag(const hands::Drag& drag) {
    const double scale = pixels_per_unit();
    drags_.push_back(drag);
    drags_.back().at_x = static_cast<float>(scale * last_x_);
    drags_.back().at_y = static_cast<float>(scale * last_y_);
}

void Window::on_button(int button, int action, int modifiers) {
    if (action == GLFW_RELEASE) {
        if (button == held_ && drag_start_.mark != hands::Drag::Mark::none) {
            hands::Drag ended = drag_start_;
            ended.mark = hands::Drag::Mark::ends;
            push_drag(ended);
        }
        held_ = button == held_ ? -1 : held_;
    } else if (button == GLFW_MOUSE_BUTTON_LEFT || button == GLFW_MOUSE_BUTTON_RIGHT) {
        held_ = button;
        const double scale = pixels_per_unit();
        drag_start_ = {.from_x = static_cast<float>(scale * last_x_),
                       .from_y = static_cast<float>(scale * last_y_),
                       .right_button = button == GLFW_MOUSE_BUTTON_RIGHT,
                       .shift = (modifiers & GLFW_MOD_SHIFT) != 0};
        if (button == GLFW_MOUSE_BUTTON_LEFT && drag_start_.shift) {
            drag_start_.mark = hands::Drag::Mark::begins;
            push_drag(drag_start_);
            drag_start_.mark = hands::Drag::Mark::continues;
        }
    }
}

void Window::on_move(double x, double y) {
    const double scale = pixels_per_unit();
    hands::Drag moved = drag_start_;
    moved.x = static_cast<float>(scale * (x - last_x_));
    moved.y = static_cast<float>(scale * (y - last_y_));
    last_x_ = x;
    last_y_ = y;
    if (held_ >= 0) {
        push_drag(moved);
    }
}

void Window::on_wheel(double notches) {
    const double scale = pixels_per_unit();
    drags_.push_back({.from_x = static_cast<float>(scale * last_x_),
                      .from_y = static_cast<float>(scale * last_y_),
                      .notches = static_cast<float>(notches),
                      .shift = shift_down()});
}

}  // namespace eti::client
