// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/input/keyboard.hpp"

#include <optional>

#include "common/process/terminal.hpp"
#include "devices/sensor/polled_sensor.hpp"

namespace eti::devices {

namespace {

// A held key repeats about 30 times a second: it deflects its axis without gaps.
constexpr std::chrono::milliseconds deflection{100};

class Keyboard final : public SampleSource {
  public:
    void open() override {
        terminal_.emplace();
        if (!terminal_->there()) {
            terminal_.reset();
            throw DeviceError("standard input is not a foreground terminal. Run this in a terminal");
        }
    }

    bool read(Sample& sample) override {
        const std::optional<char> key = terminal_->key(read_timeout);
        const auto now = std::chrono::steady_clock::now();
        bool changed = false;
        for (std::size_t axis = 0; axis < until_.size(); ++axis) {
            if (sample.axes[axis] != 0.0f && now > until_[axis]) {
                sample.axes[axis] = 0.0f;
                changed = true;
            }
        }
        if (!key) {
            return changed;
        }
        const auto deflect = [&](std::size_t axis, float by) {
            sample.axes[axis] = by;
            until_[axis] = now + deflection;
            return true;
        };
        switch (*key) {
            case '\0':
                throw DeviceError("the terminal was closed");
            case 'L':
                return deflect(0, -1.0f);
            case 'R':
                return deflect(0, 1.0f);
            case 'U':  // as a pad's stick: away from the body is negative
                return deflect(1, -1.0f);
            case 'D':
                return deflect(1, 1.0f);
            case '[':
                return deflect(4, 1.0f);
            case ']':
                return deflect(4, -1.0f);  // up
            case 'b':
                return deflect(3, 1.0f);
            case 'v':
                return deflect(3, -1.0f);
            case 'l':
                return deflect(6, 1.0f);
            case 'j':
                return deflect(6, -1.0f);
            case 'i':
                return deflect(7, -1.0f);
            case 'k':
                return deflect(7, 1.0f);
            case 's':
                sample.buttons ^= 1u;
                return true;
            default:
                return changed;
        }
    }

    void close() noexcept override { terminal_.reset(); }

  private:
    std::optional<Terminal> terminal_;
    std::array<std::chrono::steady_clock::time_point, axis_count> until_{};
};

}  // namespace

std::unique_ptr<Sensor> open_keyboard(const SensorSetup&) {
    return std::make_unique<PolledSensor>(std::make_unique<Keyboard>(), RigidTransform{});
}

}  // namespace eti::devices
