// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/trakstar.hpp"

#include <array>
#include <charconv>
#include <thread>

#include "common/math/units.hpp"
#include "devices/sensor/polled_sensor.hpp"
#include "devices/sensor/vendor/trakstar_api.hpp"

namespace eti::devices {

namespace trakstar {

Api::Api(const VendorLibrary& library) {
    library.bind(initialize, "InitializeBIRDSystem");
    library.bind(close, "CloseBIRDSystem");
    library.bind(set_system, "SetSystemParameter");
    library.bind(set_sensor, "SetSensorParameter");
    library.bind(newest_record, "GetAsynchronousRecord");
    library.bind(sensor_status, "GetSensorStatus");
    library.bind(error_text, "GetErrorText");
}

}  // namespace trakstar

namespace {

using namespace trakstar;

constexpr const char* trakstar_remedy =
    "Install the 3D Guidance API for Linux of Ascension (now NDI), or name its library with --library";
constexpr float cycles_per_second = 80.0f;  // measurement cycles; the vendor's default
constexpr std::chrono::milliseconds poll_interval{1};

unsigned short sensor_number(const std::string& text) {
    unsigned short number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (!text.empty() && (error != std::errc() || end != text.data() + text.size() || number > 15)) {
        throw DeviceError("--source " + text + ": expected the number of a sensor, 0 to 15");
    }
    return number;
}

class Trakstar final : public SampleSource {
  public:
    explicit Trakstar(const SensorSetup& setup)
        : library_(setup.library, {"libATC3DG.so", "libATC3DGm.so"}, trakstar_remedy),
          api_(library_),
          sensor_(sensor_number(setup.source)) {}

    void open() override {
        check(api_.initialize(), "the tracker does not start");
        int on = 1;
        check(api_.set_system(metric, &on, sizeof on), "the tracker rejects millimetres");
        double rate = static_cast<double>(cycles_per_second);
        check(api_.set_system(measurement_rate, &rate, sizeof rate),
              "the tracker rejects the measurement rate");
        int format = position_matrix_time_quality;
        check(api_.set_sensor(sensor_, data_format, &format, sizeof format),
              "the tracker rejects the data format");
        short transmitter = 0;
        check(api_.set_system(select_transmitter, &transmitter, sizeof transmitter),
              "the transmitter does not start");
        time_ = -1.0;
        last_ = Vec3f::Zero();
    }

    bool read(Sample& sample) override {
        Record record{};
        check(api_.newest_record(sensor_, &record, sizeof record), "the tracker does not answer");
        const unsigned int status = api_.sensor_status(sensor_);
        if ((status & (not_attached | no_transmitter)) != 0) {
            throw DeviceError((status & not_attached) != 0
                                  ? "sensor " + std::to_string(sensor_) + " is not plugged in"
                                  : std::string("the transmitter is not plugged in or not running"));
        }
        // Saturated, out of range, or still starting: no measurement now, but the device is present.
        if (status != 0 || record.time == time_) {
            std::this_thread::sleep_for(poll_interval);
            return false;
        }
        time_ = record.time;
        Mat3f rotation;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                rotation(column, row) = static_cast<float>(record.rotation[row][column]);
            }
        }
        // The transmitter's field is the same on its other side, so the tracker cannot tell the two apart:
        // choose the position closer to the last one.
        Vec3f position = millimetre * Vec3d(record.x, record.y, record.z).cast<float>();
        position *= position.dot(last_) < 0.0f ? -1.0f : 1.0f;
        last_ = position.allFinite() ? position : last_;
        sample.pose = {rotation_or_nan(rotation), position};
        return true;
    }

    void close() noexcept override { (void)api_.close(); }
    [[nodiscard]] float rate() const override { return cycles_per_second; }

  private:
    void check(int code, const char* what) const {
        if (code != 0) {
            std::array<char, 256> text{};
            (void)api_.error_text(code, text.data(), text.size(), 0);
            text.back() = '\0';
            throw DeviceError(std::string(what) + ": " + text.data() + ". Check its cables and power");
        }
    }

    VendorLibrary library_;
    Api api_;
    unsigned short sensor_;
    double time_ = -1.0;          // [s], of the last record
    Vec3f last_ = Vec3f::Zero();  // [m], last position; zero: unknown
};

}  // namespace

std::unique_ptr<Sensor> open_trakstar(const SensorSetup& setup) {
    return std::make_unique<PolledSensor>(std::make_unique<Trakstar>(setup), parked_pose(setup.tool));
}

}  // namespace eti::devices
