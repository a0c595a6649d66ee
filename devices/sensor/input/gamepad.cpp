// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/input/gamepad.hpp"

#include <fcntl.h>
#include <linux/joystick.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/process/files/descriptor.hpp"
#include "devices/sensor/polled_sensor.hpp"

namespace eti::devices {

namespace {

constexpr float full_deflection = 32767.0f;

class Gamepad final : public SampleSource {
  public:
    explicit Gamepad(std::string file) : file_(std::move(file)) {}

    void open() override {
        pad_ = Descriptor(::open(file_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
        if (!pad_) {
            throw DeviceError(
                file_ + ": " + std::strerror(errno) +
                ". Plug in the gamepad, name its file with --source, and make it readable (group input)");
        }
    }

    bool read(Sample& sample) override {
        pollfd waiting{pad_.get(), POLLIN, 0};
        if (::poll(&waiting, 1, static_cast<int>(read_timeout.count())) <= 0) {
            return false;
        }
        js_event event{};
        const ssize_t got = ::read(pad_.get(), &event, sizeof event);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return false;
        }
        if (got != static_cast<ssize_t>(sizeof event)) {
            throw DeviceError(file_ + ": the gamepad was unplugged. Plug it in");
        }
        const unsigned int kind = event.type & ~static_cast<unsigned int>(JS_EVENT_INIT);
        if (kind == JS_EVENT_AXIS && event.number < axis_count) {
            sample.axes[event.number] =
                std::clamp(static_cast<float>(event.value) / full_deflection, -1.0f, 1.0f);
            return true;
        }
        if (kind == JS_EVENT_BUTTON && event.number < 32) {
            const std::uint32_t bit = 1u << event.number;
            sample.buttons = event.value != 0 ? sample.buttons | bit : sample.buttons & ~bit;
            return true;
        }
        return false;
    }

    void close() noexcept override { pad_.close(); }

  private:
    std::string file_;
    Descriptor pad_;
};

}  // namespace

std::unique_ptr<Sensor> open_gamepad(const SensorSetup& setup) {
    return std::make_unique<PolledSensor>(
        std::make_unique<Gamepad>(setup.source.empty() ? "/dev/input/js0" : setup.source), RigidTransform{});
}

}  // namespace eti::devices
