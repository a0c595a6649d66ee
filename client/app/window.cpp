// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "client/app/command_keys.hpp"
#include "common/math/units.hpp"

namespace eti::client {
namespace {

constexpr float turn_per_pixel = 0.35f * degree;
constexpr float zoom_per_notch = 0.92f;

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
            "no window can be opened ({}). Without a display use --offscreen DIR.", last_glfw_error()));
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        const std::string error = last_glfw_error();
        glfwTerminate();
        throw std::runtime_error(fmt::format(
            "no window with OpenGL 3.3 can be opened ({}). Install a driver, or use --offscreen DIR.",
            error));
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int scancode, int action, int) {
        window_of(w).on_key(key, scancode, action);
    });
    // As characters: where they lie on the keyboard differs between languages.
    glfwSetCharCallback(window_,
                        [](GLFWwindow* w, unsigned character) { window_of(w).on_character(character); });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
        if (button == GLFW_MOUSE_BUTTON_LEFT) {
            Window& self = window_of(w);
            self.dragging_ = action == GLFW_PRESS;
            glfwGetCursorPos(w, &self.last_x_, &self.last_y_);
        }
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { window_of(w).on_drag(x, y); });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double notches) {
        float& distance = window_of(w).orbit_.distance;
        distance =
            std::clamp(distance * (notches > 0.0 ? zoom_per_notch : 1.0f / zoom_per_notch), 0.2f, 1.5f);
    });
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

void Window::show_frame() {
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

void Window::on_key(int key, int scancode, int action) {
    repeating_ = action == GLFW_REPEAT;
    if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS) {
        glfwSetWindowShouldClose(window_, GLFW_TRUE);
    }
    for (const auto& [code, arrow] :
         {std::pair{GLFW_KEY_LEFT, key_left}, std::pair{GLFW_KEY_UP, key_up},
          std::pair{GLFW_KEY_RIGHT, key_right}, std::pair{GLFW_KEY_DOWN, key_down}}) {
        if (key == code) {
            keys_.push_back({arrow, action != GLFW_RELEASE, repeating_});
        }
    }
    // Characters go down in on_character(), but come up here alone.
    const char* const name = action == GLFW_RELEASE ? glfwGetKeyName(key, scancode) : nullptr;
    if (name != nullptr && name[0] > 0 && name[1] == 0) {
        keys_.push_back({lower(static_cast<unsigned char>(name[0])), false, false});
    }
}

void Window::on_character(unsigned character) {
    keys_.push_back({lower(character), true, repeating_});
}

void Window::on_drag(double x, double y) {
    if (dragging_) {
        orbit_.azimuth -= turn_per_pixel * static_cast<float>(x - last_x_);
        orbit_.elevation = std::clamp(orbit_.elevation + turn_per_pixel * static_cast<float>(y - last_y_),
                                      -60.0f * degree, 85.0f * degree);
    }
    last_x_ = x;
    last_y_ = y;
}

}  // namespace eti::client
