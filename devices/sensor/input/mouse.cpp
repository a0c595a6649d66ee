// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/input/mouse.hpp"

#ifdef ETI_GLFW

#include <GLFW/glfw3.h>

#include <array>
#include <atomic>
#include <chrono>

#include "common/math/units.hpp"
#include "common/process/threads/mailbox.hpp"
#include "devices/sensor/operator_frame.hpp"

namespace eti::devices {

namespace {

constexpr float metre_per_pixel = 0.2e-3f;
constexpr float radian_per_pixel = 0.2f * degree;
constexpr float metre_per_notch = 2e-3f;       // of the wheel
constexpr float key_speed = 0.03f;             // [m/s]
constexpr float key_turning = 30.0f * degree;  // [rad/s]
constexpr float longest_key_interval = 0.1f;   // [s], between two polls of the keys

/// A key that deflects one of x, y, z.
struct Key {
    int code;
    Vec3f direction;
};

class Mouse final : public Sensor {
  public:
    explicit Mouse(const SensorSetup& setup) : pose_(parked_pose(setup.tool)) {
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
        const float dt = std::min(std::chrono::duration<float>(now - looked_).count(), longest_key_interval);
        looked_ = now;
        double x = 0.0, y = 0.0;
        glfwGetCursorPos(window_, &x, &y);
        const Vec3f drag(static_cast<float>(x - x_), static_cast<float>(y_ - y), 0.0f);  // pixels, y up
        x_ = x;
        y_ = y;

        Vec3f way = key_speed * dt * pressed(moves), turn = key_turning * dt * pressed(turns);
        if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
            way += metre_per_pixel * drag;
        }
        if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
            // Dragging right turns about the vertical axis, dragging up about the lateral one.
            turn += radian_per_pixel * Vec3f(-drag.y(), drag.x(), 0.0f);
        }
        way.z() -= metre_per_notch * wheel_;  // forward: away from the body
        wheel_ = 0.0f;
        pose_ = moved(pose_, way, turn);
        velocity_ = dt > 0.0f ? Vec3f(from_operator(way) / dt) : Vec3f(Vec3f::Zero());
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
    static const std::array<Key, 6> moves, turns;

    static std::string glfw_words() {
        const char* words = nullptr;
        (void)glfwGetError(&words);
        return words == nullptr ? "no reason given" : words;
    }

    [[nodiscard]] Vec3f pressed(const std::array<Key, 6>& keys) const {
        Vec3f sum = Vec3f::Zero();
        for (const Key& key : keys) {
            if (glfwGetKey(window_, key.code) == GLFW_PRESS) {
                sum += key.direction;
            }
        }
        return sum;
    }

    void hand_over() {
        Reading reading;
        reading.motion = {pose_, velocity_, Vec3f::Zero()};
        reading.buttons = glfwGetKey(window_, GLFW_KEY_SPACE) == GLFW_PRESS ? 1u : 0u;
        reading.present = !closed_;
        newest_.write(reading);
    }

    GLFWwindow* window_ = nullptr;
    RigidTransform pose_;
    Vec3f velocity_ = Vec3f::Zero();
    double x_ = 0.0, y_ = 0.0;  // cursor
    float wheel_ = 0.0f;        // notches since the last poll
    std::atomic<bool> closed_{false};
    std::chrono::steady_clock::time_point looked_;
    Mailbox<Reading> newest_;
    std::uint64_t calls_ = 0;
};

const std::array<Key, 6> Mouse::moves = {{{GLFW_KEY_D, Vec3f::UnitX()},
                                          {GLFW_KEY_A, -Vec3f::UnitX()},
                                          {GLFW_KEY_R, Vec3f::UnitY()},
                                          {GLFW_KEY_F, -Vec3f::UnitY()},
                                          {GLFW_KEY_S, Vec3f::UnitZ()},
                                          {GLFW_KEY_W, -Vec3f::UnitZ()}}};
const std::array<Key, 6> Mouse::turns = {{{GLFW_KEY_I, Vec3f::UnitX()},
                                          {GLFW_KEY_K, -Vec3f::UnitX()},
                                          {GLFW_KEY_J, Vec3f::UnitY()},
                                          {GLFW_KEY_L, -Vec3f::UnitY()},
                                          {GLFW_KEY_U, Vec3f::UnitZ()},
                                          {GLFW_KEY_O, -Vec3f::UnitZ()}}};

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
