// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/input/mouse.hpp"

#ifdef ETI_GLFW

#include <GLFW/glfw3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "common/device/held_tool.hpp"
#include "common/process/threads/mailbox.hpp"
#include "devices/sensor/operator_frame.hpp"

namespace eti::devices {

namespace {

constexpr float metre_per_pixel = 0.2e-3f;
constexpr float radian_per_pixel = 0.2f * degree;
constexpr float longest_interval = 0.1f;  // [s], between two polls

class Mouse final : public Sensor {
  public:
    explicit Mouse(const SensorSetup& setup)
        : hand_(setup.tool_length, setup.curvature, parked_pose(setup.tool)) {
        if (glfwInit() != GLFW_TRUE) {
            throw DeviceError(std::string("--device mouse: no window: ") + glfw_words() +
                              ". Run it in a desktop session, or with DISPLAY set");
        }
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
        glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
        window_ = glfwCreateWindow(
            480, 320, "NeoETI hand: drag left moves, drag right turns, wheel in and out, space suction",
            nullptr, nullptr);
        if (window_ == nullptr) {
            const std::string words = glfw_words();
            glfwTerminate();
            throw DeviceError("--device mouse: no window: " + words);
        }
        glfwSetWindowUserPointer(window_, this);
        glfwSetScrollCallback(window_, [](GLFWwindow* window, double, double notches) {
            static_cast<Mouse*>(glfwGetWindowUserPointer(window))->wheel_ += static_cast<float>(notches);
        });
        glfwGetCursorPos(window_, &x_, &y_);
        looked_ = std::chrono::steady_clock::now();
        hand_over();
    }

    ~Mouse() override {
        glfwDestroyWindow(window_);
        glfwTerminate();
    }

    void poll_events() override {
        glfwPollEvents();
        const auto now = std::chrono::steady_clock::now();
        const float dt = std::min(std::chrono::duration<float>(now - looked_).count(), longest_interval);
        looked_ = now;
        double x = 0.0, y = 0.0;
        glfwGetCursorPos(window_, &x, &y);
        const Vec3f drag(static_cast<float>(x - x_), static_cast<float>(y_ - y), 0.0f);  // pixels, y up
        x_ = x;
        y_ = y;

        if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
            hand_.move(from_operator(metre_per_pixel * drag));
        }
        if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
            // Dragging right turns about the vertical axis, dragging up about the lateral one.
            const Vec3f turn = from_operator(radian_per_pixel * Vec3f(-drag.y(), drag.x(), 0.0f));
            hand_.turn(hand_.target().rotation.conjugate() * turn);
        }
        hand_.slide(slide_per_notch * std::exchange(wheel_, 0.0f));
        for (const HandKey& key : hand_keys()) {
            if (pressed(key.key)) {
                hand_.hold(key, dt);
            }
        }
        if (pressed(home_key)) {
            hand_.go_home();
        }
        const Vec3f before = hand_.pose().translation;
        hand_.advance(dt, {});
        velocity_ = dt > 0.0f ? Vec3f((hand_.pose().translation - before) / dt) : Vec3f(Vec3f::Zero());
        closed_ = glfwWindowShouldClose(window_) != 0;
        hand_over();
    }

    Reading exchange(const Wrench&, float) override {
        const Reading* newest = nullptr;
        (void)newest_.read(newest);
        Reading reading = *newest;
        reading.sample = ++calls_;
        return reading;
    }

    [[nodiscard]] std::string fault() const override {
        return closed_ ? "its window was closed; start the program again" : "";
    }

  private:
    static std::string glfw_words() {
        const char* words = nullptr;
        (void)glfwGetError(&words);
        return words == nullptr ? "no reason given" : words;
    }

    /// `letter`: lower-case. GLFW names a key by its capital letter on a US keyboard.
    [[nodiscard]] bool pressed(char32_t letter) const {
        return glfwGetKey(window_, static_cast<int>(letter - U'a' + GLFW_KEY_A)) == GLFW_PRESS;
    }

    void hand_over() {
        Reading reading;
        reading.motion = {hand_.pose(), velocity_, Vec3f::Zero()};
        reading.buttons = glfwGetKey(window_, GLFW_KEY_SPACE) == GLFW_PRESS ? 1u : 0u;
        reading.present = !closed_;
        newest_.write(reading);
    }

    GLFWwindow* window_ = nullptr;
    HeldTool hand_;
    Vec3f velocity_ = Vec3f::Zero();
    double x_ = 0.0, y_ = 0.0;  // cursor
    float wheel_ = 0.0f;        // notches since the last poll
    std::atomic<bool> closed_{false};
    std::chrono::steady_clock::time_point looked_;
    Mailbox<Reading> newest_;
    std::uint64_t calls_ = 0;
};

}  // namespace

std::unique_ptr<Sensor> open_mouse(const SensorSetup& setup) {
    return std::make_unique<Mouse>(setup);
}

}  // namespace eti::devices

#else

namespace eti::devices {

std::unique_ptr<Sensor> open_mouse(const SensorSetup&) {
    throw DeviceError("--device mouse: built without GLFW. Configure with -DETI_CLIENT=ON");
}

}  // namespace eti::devices

#endif
