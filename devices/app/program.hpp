// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/echo.hpp"
#include "common/process/command_line.hpp"
#include "devices/calibration/calibration_file.hpp"
#include "devices/haptics/scene_link.hpp"
#include "devices/sensor/drivers.hpp"
#include "devices/sensor/sensor_watch.hpp"

namespace eti::devices {

/// What both device programs understand.
struct ProgramOptions {
    std::string device;
    std::string source;         ///< of the device: file, name or number; empty: the usual one
    std::string library;        ///< the vendor's, by path; empty: by its usual names
    std::string calibration;    ///< file of eti-calibrate; empty: none
    std::string operator_name;  ///< by name or path; empty: nobody moves the tool
    bus::Options bus;
    double duration = 0.0;  ///< [s] of the clock; 0: until the session ends
    bool json = false;
    bool haptic = false;  ///< forces are rendered: what is felt is followed too
};

/// Adds these options to the program's own.
void add_options(CommandLine& app, ProgramOptions& options);

/// Of a device alone: which, where, by what library.
void add_device_options(CommandLine& app, ProgramOptions& options, Use use);

/// Of the bus and of the program's end.
void add_bus_options(CommandLine& app, ProgramOptions& options);

/// Logs go to standard error; Ctrl-C, SIGTERM, SIGQUIT and a closed terminal end the program in order.
void set_up_process(const std::string& name);

/// What a program's main does once its options are declared: parses, runs `work`, and turns an exception into
/// its text in the log. Returns the exit status.
[[nodiscard]] int run_program(CommandLine& app, int argc, char** argv, const std::function<int()>& work);

/// A device program's life: its place on the bus, its device, and why it ended.
class Program {
  public:
    /// Throws DeviceError, InputError or bus::BusError.
    Program(const ProgramOptions& options, Tool tool);

    /// Waits, where a script needs it, until the server has shown the scene, and opens the device.
    /// Null when the program was asked to end first.
    [[nodiscard]] std::unique_ptr<Sensor> open_sensor();

    /// Where on the tool the device holds it, tool frame [m]; the origin without a calibration.
    [[nodiscard]] Vec3f gimbal() const;

    /// Says what has changed about the device's health since last asked.
    void report(const SensorWatch& watch);

    /// True when there is a reason to end; it is kept for ended().
    [[nodiscard]] bool should_end();
    [[nodiscard]] const std::string& ended() const { return ended_; }
    [[nodiscard]] double seconds() const;
    /// Asks the server once a second how long messages take, and warns where that is more than a hand
    /// forgives.
    void watch_latency();
    /// [ms], there and back; nothing before the server has answered.
    [[nodiscard]] std::optional<double> round_trip_ms() const { return round_trip_ms_; }
    [[nodiscard]] bus::Node& node() { return node_; }
    [[nodiscard]] SceneLink& link() { return link_; }
    [[nodiscard]] const ProgramOptions& options() const { return options_; }

  private:
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
    bus::EchoAsker echo_;
    std::chrono::steady_clock::time_point asked_{}, warned_{};
    std::optional<double> round_trip_ms_;
    std::string ended_;
};

}  // namespace eti::devices
