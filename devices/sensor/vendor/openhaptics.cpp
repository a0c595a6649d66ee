// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/openhaptics.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>

#include "common/math/units.hpp"
#include "devices/sensor/vendor/openhaptics_api.hpp"

namespace eti::devices {

namespace openhaptics {

Api::Api(const VendorLibrary& library) {
    library.bind(init_device, "hdInitDevice");
    library.bind(disable_device, "hdDisableDevice");
    library.bind(make_current, "hdMakeCurrentDevice");
    library.bind(begin_frame, "hdBeginFrame");
    library.bind(end_frame, "hdEndFrame");
    library.bind(enable, "hdEnable");
    library.bind(get_doubles, "hdGetDoublev");
    library.bind(get_integers, "hdGetIntegerv");
    library.bind(get_string, "hdGetString");
    library.bind(set_doubles, "hdSetDoublev");
    library.bind(get_error, "hdGetError");
    library.bind(error_string, "hdGetErrorString");
    library.bind(start_scheduler, "hdStartScheduler");
    library.bind(stop_scheduler, "hdStopScheduler");
    library.bind(schedule, "hdScheduleAsynchronous");
    library.bind(unschedule, "hdUnschedule");
}

}  // namespace openhaptics

namespace {

using namespace openhaptics;
using Clock = std::chrono::steady_clock;

constexpr const char* openhaptics_remedy =
    "Install OpenHaptics for Linux and the Touch device driver from 3D Systems, run its set-up, or name "
    "libHD with --library";
constexpr float newton_millimetre = 1e-3f;  // [N m]
constexpr int max_errors = 64;              // capacity of the library's error queue
constexpr std::chrono::milliseconds servo_retry_interval{1000};
constexpr std::chrono::milliseconds servo_timeout{500};

Vec3f vector_of(const std::array<double, 3>& v) {
    return Vec3d(v[0], v[1], v[2]).cast<float>();
}

class OpenHaptics final : public Sensor {
  public:
    explicit OpenHaptics(const SensorSetup& setup)
        : library_(setup.library, {"libHD.so", "libHD.so.3.4", "libHD.so.3"}, openhaptics_remedy),
          api_(library_),
          name_(setup.source) {
        const std::string refused = open();
        if (!refused.empty()) {
            throw DeviceError("OpenHaptics cannot open the device '" +
                              (name_.empty() ? "Default Device" : name_) + "': " + refused +
                              ". Check its cable and power, its name in the vendor's set-up, and pairing");
        }
    }

    ~OpenHaptics() override {
        stop_servo();
        close();
    }

    Reading exchange(const Wrench& asked, float) override {
        if (device_ == no_device) {
            last_.present = false;
            return last_;
        }
        // Last safeguard: NaN never reaches a motor.
        const Wrench wrench = asked.is_finite() ? asked : Wrench{};
        api_.begin_frame(device_);
        std::array<double, 16> transform{};
        std::array<double, 3> velocity{}, turning{};
        int buttons = 0;
        api_.get_doubles(current_transform, transform.data());
        api_.get_doubles(current_velocity, velocity.data());
        api_.get_doubles(current_angular_velocity, turning.data());
        api_.get_integers(current_buttons, &buttons);
        const std::array<double, 3> force{wrench.force.x(), wrench.force.y(), wrench.force.z()};
        api_.set_doubles(current_force, force.data());
        if (capabilities_.torque > 0.0f) {
            const Vec3d t = wrench.torque.cast<double>() / static_cast<double>(newton_millimetre);
            const std::array<double, 3> torque{t.x(), t.y(), t.z()};
            api_.set_doubles(current_torque, torque.data());
        }
        api_.end_frame(device_);
        cycled_.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed);

        const ErrorInfo error = api_.get_error();
        if ((error.code & error_class) == device_errors) {
            error_.store(error.code, std::memory_order_relaxed);
            last_.present = false;
            return last_;
        }
        Mat3f rotation;
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
                rotation(row, column) =
                    static_cast<float>(transform[static_cast<std::size_t>(4 * column + row)]);
            }
        }
        last_.motion.pose = {rotation_or_nan(rotation),
                             millimetre * vector_of({transform[12], transform[13], transform[14]})};
        last_.motion.velocity = millimetre * vector_of(velocity);
        last_.motion.angular_velocity = vector_of(turning);
        last_.buttons = static_cast<std::uint32_t>(buttons);
        ++last_.sample;
        last_.present = true;
        return last_;
    }

    [[nodiscard]] DeviceCapabilities capabilities() const override { return capabilities_; }

    bool start_servo(ServoCycle& cycle) override {
        cycle_ = &cycle;
        cycled_.store(Clock::now().time_since_epoch().count(), std::memory_order_relaxed);
        schedule_ = api_.schedule(
            [](void* context) {
                static_cast<ServoCycle*>(context)->servo_cycle();
                return callback_continue;
            },
            cycle_, highest_priority);
        api_.start_scheduler();
        return true;
    }

    void stop_servo() override {
        if (cycle_ != nullptr) {
            api_.stop_scheduler();
            api_.unschedule(schedule_);
            cycle_ = nullptr;
        }
    }

    /// Reopens a lost device once a second, with the servo thread stopped.
    void poll_events() override {
        const std::int64_t idle =
            Clock::now().time_since_epoch().count() - cycled_.load(std::memory_order_relaxed);
        const bool asleep = cycle_ != nullptr && idle > Clock::duration(servo_timeout).count();
        const unsigned int code = error_.load(std::memory_order_relaxed);
        if ((code == success && !asleep) || Clock::now() < retry_) {
            return;
        }
        retry_ = Clock::now() + servo_retry_interval;
        ServoCycle* const cycle = cycle_;
        if (code != success) {
            report(words_for(code) + "; check the device's cable and power");
        } else {
            report("the vendor's servo thread has stopped");
        }
        stop_servo();
        close();
        if (open().empty()) {
            error_.store(success, std::memory_order_relaxed);
            report({});
        }
        if (cycle != nullptr) {
            start_servo(*cycle);
        }
    }

    [[nodiscard]] std::string fault() const override {
        const std::lock_guard lock(mutex_);
        return fault_;
    }

  private:
    [[nodiscard]] std::string words_for(unsigned int code) const {
        const char* words = api_.error_string(code);
        return words == nullptr ? "no reason given" : words;
    }

    /// Returns the reason of a failure, or an empty text.
    std::string open() {
        for (int i = 0; i < max_errors && api_.get_error().code != success; ++i) {
        }
        device_ = api_.init_device(name_.empty() ? nullptr : name_.c_str());
        const ErrorInfo error = api_.get_error();
        if (error.code != success || device_ == no_device) {
            device_ = no_device;
            return words_for(error.code);
        }
        api_.make_current(device_);
        int dof = 3;
        double force = 0.0, torque = 0.0;
        api_.get_integers(output_dof, &dof);
        api_.get_doubles(nominal_max_force, &force);
        if (dof >= 6) {
            api_.get_doubles(nominal_max_torque, &torque);
        }
        api_.enable(force_output);
        capabilities_ = {.force = static_cast<float>(force),
                         .torque = newton_millimetre * static_cast<float>(torque),
                         .rate = 1000.0f};
        return {};
    }

    void close() {
        if (device_ != no_device) {
            api_.disable_device(device_);
            device_ = no_device;
        }
    }

    void report(const std::string& fault) {
        const std::lock_guard lock(mutex_);
        fault_ = fault;
    }

    VendorLibrary library_;
    Api api_;
    std::string name_;
    Handle device_ = no_device;
    Schedule schedule_ = 0;
    ServoCycle* cycle_ = nullptr;
    DeviceCapabilities capabilities_;
    Reading last_;
    Clock::time_point retry_;
    std::atomic<std::int64_t> cycled_{0};  // time of the servo thread's last call
    std::atomic<unsigned int> error_{success};
    mutable std::mutex mutex_;
    std::string fault_;  // guarded by mutex_
};

}  // namespace

std::unique_ptr<Sensor> open_openhaptics(const SensorSetup& setup) {
    return std::make_unique<OpenHaptics>(setup);
}

}  // namespace eti::devices
