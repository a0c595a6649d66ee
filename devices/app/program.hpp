// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/echo.hpp"
#include "common/process/program.hpp"
#include "common/process/service_notify.hpp"
#include "devices/calibration/calibration_file.hpp"
#include "devices/haptics/scene_link.hpp"
#include "devices/sensor/drivers.hpp"
#include "devices/sensor/sensor_monitor.hpp"

namespace eti::devices {

/// Options that all device programs accept.
struct ProgramOptions {
    std::string device;
    std::string source;         ///< of the device: file, name or number; empty: the default
    std::string library;        ///< path of the vendor's library; empty: its usual names
    std::string calibration;    ///< file of eti-calibrate; empty: none
    bool uncalibrated = false;  ///< accept a device that needs a calibration without one
    std::string operator_name;  ///< by name or path; empty: the tool does not move
    bus::Options bus;
    double duration = 0.0;  ///< [s] of real time; 0: until the session ends
    bool json = false;
    bool haptic = false;  ///< forces are rendered, so force messages are subscribed to
};

/// Adds these options to the program's own.
void add_options(CommandLine& app, ProgramOptions& options);

/// Device options only: which device, where, and by which library.
void add_device_options(CommandLine& app, ProgramOptions& options, DeviceRole role);

/// Options of the bus and of the program's duration.
void add_bus_options(CommandLine& app, ProgramOptions& options);

/// A closed terminal or output pipe ends no device program at once.
inline constexpr StopSignals device_signals{.holds_device = true};

/// Common parts of a device program: bus node, device, service, and reason to end.
class Program {
  public:
    /// Throws DeviceError, InputError or bus::BusError.
    Program(const ProgramOptions& options, Tool tool);

    /// Opens the device, runs `work`, which returns its statistics when should_end(), and prints them with
    /// those of bus and device. With a script, first waits until the scene has arrived; does not run `work`
    /// if the program is asked to end before that.
    void run(const std::function<nlohmann::ordered_json(SensorMonitor&)>& work);

    /// Position of the device's attachment, tool frame [m]; the origin without a calibration.
    [[nodiscard]] Vec3f gimbal() const;

    /// Logs changes of the device's health since the last call.
    void report(const SensorMonitor& watch);

    /// True when there is a reason to end, which the service manager then knows.
    [[nodiscard]] bool should_end();
    /// Reports progress to the service manager.
    void alive() { service_.alive(); }
    /// Measures the round trip to the server once a second, and warns where it is too long for a hand.
    void watch_latency();
    /// [ms]; nullopt before the first answer.
    [[nodiscard]] std::optional<double> round_trip_ms() const { return round_trip_ms_; }
    [[nodiscard]] bus::Node& node() { return node_; }
    [[nodiscard]] SceneLink& link() { return link_; }

  private:
    /// Null if the program was asked to end before the scene has arrived.
    [[nodiscard]] std::unique_ptr<Sensor> open_sensor();
    [[nodiscard]] double seconds() const;

    ProgramOptions options_;
    Tool tool_;
    const Driver& driver_;
    std::optional<OperatorScript> script_;
    std::optional<Calibration> calibration_;
    SensorHealth reported_;
    std::string reported_fault_;
    std::chrono::steady_clock::time_point started_;
    bus::Node node_;
    SceneLink link_;
    bus::EchoRequester echo_;
    std::chrono::steady_clock::time_point asked_{}, warned_{};
    std::optional<double> round_trip_ms_;
    ServiceNotify service_;
    std::string ended_;
};

}  // namespace eti::devices
