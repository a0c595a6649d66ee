// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/spacenav.hpp"

#include <poll.h>
#include <spnav.h>

#include <algorithm>

#include "common/math/units.hpp"
#include "devices/sensor/operator_frame.hpp"
#include "devices/sensor/polled_sensor.hpp"
#include "devices/sensor/vendor/vendor_library.hpp"

namespace eti::devices {

namespace {

constexpr const char* spacenav_remedy = "Install Debian's packages libspnav0 and spacenavd";
constexpr float full_push = 350.0f;             // what spacenavd reports at its default sensitivity
constexpr float full_speed = 0.10f;             // [m/s]
constexpr float full_turning = 60.0f * degree;  // [rad/s]
constexpr unsigned int longest_period = 50;     // [ms]; the first event after a pause has no valid period

class Spacenav final : public SampleSource {
  public:
    explicit Spacenav(const SensorSetup& setup)
        : library_(setup.library, {"libspnav.so.0"}, spacenav_remedy) {
        library_.bind(open_, "spnav_open");
        library_.bind(close_, "spnav_close");
        library_.bind(fd_, "spnav_fd");
        library_.bind(poll_, "spnav_poll_event");
    }

    void open() override {
        if (open_() == -1) {
            throw DeviceError(
                "spacenavd is not running. Start it (systemctl start spacenavd) and plug the device in");
        }
    }

    bool read(Sample& sample) override {
        pollfd waiting{fd_(), POLLIN, 0};
        if (::poll(&waiting, 1, static_cast<int>(read_timeout.count())) <= 0) {
            return false;
        }
        spnav_event event{};
        if (poll_(&event) == 0) {
            throw DeviceError("spacenavd has closed the connection. Start it (systemctl start spacenavd)");
        }
        if (event.type == SPNAV_EVENT_MOTION) {
            const spnav_event_motion& m = event.motion;
            const float seconds = 1e-3f * static_cast<float>(std::min(m.period, longest_period));
            const auto share = [](int x, int y, int z) {
                // Its z points away from the hand.
                const Vec3f push(static_cast<float>(x), static_cast<float>(y), -static_cast<float>(z));
                return Vec3f((push / full_push).cwiseMax(-1.0f).cwiseMin(1.0f));
            };
            sample.pose = moved(sample.pose, full_speed * seconds * share(m.x, m.y, m.z),
                                full_turning * seconds * share(m.rx, m.ry, m.rz));
            return true;
        }
        if (event.type == SPNAV_EVENT_BUTTON && event.button.bnum >= 0 && event.button.bnum < 32) {
            const std::uint32_t bit = 1u << event.button.bnum;
            sample.buttons = event.button.press != 0 ? sample.buttons | bit : sample.buttons & ~bit;
            return true;
        }
        if (event.type == SPNAV_EVENT_DEV && event.dev.op == SPNAV_DEV_RM) {
            throw DeviceError("the 6-DOF mouse was unplugged. Plug it in");
        }
        return false;
    }

    void close() noexcept override { (void)close_(); }

  private:
    VendorLibrary library_;
    int (*open_)() = nullptr;
    int (*close_)() = nullptr;
    int (*fd_)() = nullptr;
    int (*poll_)(spnav_event*) = nullptr;
};

}  // namespace

std::unique_ptr<Sensor> open_spacenav(const SensorSetup& setup) {
    return std::make_unique<PolledSensor>(std::make_unique<Spacenav>(setup), parked_pose(setup.tool));
}

}  // namespace eti::devices
