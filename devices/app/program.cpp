// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/program.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <thread>

#include "common/bus/command_line.hpp"
#include "common/scenario/data_file.hpp"
#include "devices/calibration/calibrated_sensor.hpp"

namespace eti::devices {

namespace {

constexpr std::chrono::milliseconds look_for_server{1000};
constexpr std::chrono::milliseconds poll_interval{20};
constexpr std::chrono::seconds ask_interval{1}, warn_interval{10};
constexpr double slow_round_trip_ms = 20.0;

std::optional<OperatorScript> script_of(const ProgramOptions& options) {
    if (options.operator_name.empty()) {
        return std::nullopt;
    }
    return load_operator(find_data_file(options.operator_name, "operators"));
}

/// Throws DeviceError where the device needs a calibration and has none, before the session is joined.
std::optional<Calibration> calibration_of(const ProgramOptions& options, const Driver& driver) {
    if (!options.calibration.empty()) {
        if (options.uncalibrated) {
            throw DeviceError("--uncalibrated and --calibration exclude each other; leave one of them out");
        }
        return load_calibration(options.calibration);
    }
    if (driver.needs_calibration && !options.uncalibrated) {
        throw DeviceError(fmt::format(
            "--device {}: is not calibrated, so nothing is known of where the patient is in its frame; run "
            "eti-calibrate and name its file with --calibration, or try the device out with --uncalibrated",
            driver.name));
    }
    return std::nullopt;
}

SceneLink::ForceSource feel_of(const ProgramOptions& options, Tool tool) {
    if (!options.haptic) {
        return SceneLink::ForceSource::nothing;
    }
    return tool == Tool::tube ? SceneLink::ForceSource::tube : SceneLink::ForceSource::tissue;
}

}  // namespace

void add_device_options(CommandLine& app, ProgramOptions& options, DeviceRole role) {
    app.add_option("--device", options.device, driver_list(role)).required();
    app.add_option("--source", options.source, "The device's file, name or number; see --device");
    if (role == DeviceRole::tool) {
        app.add_option("--library", options.library,
                       "Path of the vendor's library, if not found automatically");
    }
}

void add_options(CommandLine& app, ProgramOptions& options) {
    add_device_options(app, options, DeviceRole::tool);
    app.add_option("--calibration", options.calibration,
                   "Calibration of the device: a file written by eti-calibrate");
    app.add_flag(
        "--uncalibrated", options.uncalibrated,
        "Use a device that needs a calibration without one: its frame is taken for the patient's, so "
        "that tools are not where the hands are");
    app.add_option("--operator", options.operator_name,
                   "Scripted hand by name or path; without it the device is held still");
    add_bus_options(app, options);
}

void add_bus_options(CommandLine& app, ProgramOptions& options) {
    bus::add_options(app, options.bus);
    app.add_number("--duration", options.duration,
                   "Exit after this time; by default at the end of the session", {0.001, 1e7, "s"});
    app.add_flag("--json", options.json, "Print the statistics as one JSON object");
}

Program::Program(const ProgramOptions& options, Tool tool)
    : options_(options),
      tool_(tool),
      driver_(find_driver(options.device, DeviceRole::tool)),
      script_(script_of(options)),
      calibration_(calibration_of(options, driver_)),
      started_(std::chrono::steady_clock::now()),
      node_(options.bus),
      link_(node_, feel_of(options, tool)),
      echo_(node_) {
    if (calibration_ && !calibration_->registered) {
        throw DeviceError(
            fmt::format("--calibration {}: is a pivot, which does not locate the patient; pass it to "
                        "eti-calibrate register --pivot, and the resulting file to this program",
                        options.calibration));
    }
    if (calibration_ && calibration_->device != options.device) {
        throw DeviceError(
            fmt::format("--calibration {}: is of device '{}', not '{}'; run eti-calibrate for this one",
                        options.calibration, calibration_->device, options.device));
    }
    if (calibration_) {
        spdlog::info("calibration of {}: {} points, {:.2f} mm (leave-one-out {:.2f} mm)", calibration_->date,
                     calibration_->points, 1e3 * calibration_->error, 1e3 * calibration_->left_out_error);
    } else if (driver_.needs_calibration) {
        spdlog::warn(
            "device '{}' is not calibrated (--uncalibrated): its frame is assumed to be the patient's",
            driver_.name);
    }
    for (const std::string& warning : bus::self_check(node_, false, look_for_server).warnings) {
        spdlog::warn("{}", warning);
    }
}

std::unique_ptr<Sensor> Program::open_sensor() {
    SensorSetup setup;
    setup.tool = tool_;
    setup.script = script_;
    setup.source = options_.source;
    setup.library = options_.library;
    if (script_) {
        spdlog::info("'{}' waits for the scene of session '{}' on domain {}", script_->name,
                     options_.bus.session, options_.bus.domain);
        std::optional<InitialScene> around;
        while (!(around = link_.initial_scene())) {
            if (should_end()) {
                return nullptr;
            }
            bus::refuse_other_protocol(node_);
            std::this_thread::sleep_for(poll_interval);
        }
        setup.start = around->seen;
        setup.tool_length = tool_ == Tool::tube ? around->grip_to_tip : around->blade_length;
        setup.curvature = tool_ == Tool::tube ? around->tube_curvature : 0.0f;
    }
    const bool scripted = driver_.name == "simulated" || driver_.name == "scripted";
    spdlog::info("device '{}' in session '{}'{}", driver_.name, options_.bus.session,
                 script_    ? ", moved by '" + script_->name + "'"
                 : scripted ? ", held still"
                            : "");
    std::unique_ptr<Sensor> sensor = driver_.open(setup);
    if (calibration_) {
        sensor = std::make_unique<CalibratedSensor>(std::move(sensor), *calibration_);
    }
    return sensor;
}

void Program::run(const std::function<nlohmann::ordered_json(SensorMonitor&)>& work) {
    const std::unique_ptr<Sensor> sensor = open_sensor();
    nlohmann::ordered_json own = {{"cycles", 0}};
    if (sensor) {
        SensorMonitor watch(*sensor);
        own = work(watch);
        own["device_losses"] = watch.health().losses;
        own["poses_left_out"] = watch.health().jumps + watch.health().not_finite;
    }
    spdlog::info("ended: {}; {} poses published", ended_, own.value("poses_published", 0));
    if (link_.refused() > 0) {
        spdlog::warn(
            "{} messages were rejected: not finite or not of this version; do the versions of server and "
            "device match?",
            link_.refused());
    }
    nlohmann::ordered_json all = {{"device", options_.device},
                                  {"session", options_.bus.session},
                                  {"ended", ended_},
                                  {"duration_s", seconds()},
                                  {"states_received", link_.received()},
                                  {"messages_refused", link_.refused()},
                                  {"outages", link_.outages()}};
    all.update(own);
    print_json(options_.json, all);
}

Vec3f Program::gimbal() const {
    return calibration_ ? calibration_->tool.inverse().translation : Vec3f(Vec3f::Zero());
}

void Program::report(const SensorMonitor& watch) {
    const SensorHealth now = watch.health();
    const std::string fault = watch.fault();
    if (now.lost && (!reported_.lost || fault != reported_fault_)) {
        spdlog::warn(
            "device '{}' lost{}; waiting for it", driver_.name,
            !fault.empty() ? ": " + fault
            : now.frozen
                ? ": it exerts force but reports no motion; move it, or unplug it and plug it in again"
                : ": it sends nothing");
    } else if (!now.lost && reported_.lost) {
        spdlog::info("device '{}' is back", driver_.name);
    }
    if (now.slow && !reported_.slow) {
        spdlog::warn(
            "device '{}' is slow: {:.0f} measurements per second, {:.0f} expected; check its cable and the "
            "load of this machine",
            driver_.name, now.rate, watch.capabilities().rate);
    }
    if ((now.jumps > 0) != (reported_.jumps > 0) || (now.not_finite > 0) != (reported_.not_finite > 0)) {
        spdlog::warn(
            "device '{}' reports impossible motion ({} jumps, {} poses that are not finite); ignored",
            driver_.name, now.jumps, now.not_finite);
    }
    reported_ = now;
    reported_fault_ = fault;
}

void Program::watch_latency() {
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < ask_interval) {
        return;
    }
    asked_ = now;
    echo_.poll();
    for (const auto& [process, peer] : echo_.peers()) {
        if (peer.program == bus::server_name) {
            // Median of the latest: one late answer does not mean a slow link.
            auto last = peer.round_trips_ms;
            last.erase(last.begin(), last.end() - std::min<std::ptrdiff_t>(5, std::ssize(last)));
            std::ranges::nth_element(last, last.begin() + std::ssize(last) / 2);
            round_trip_ms_ = last[last.size() / 2];
        }
    }
    (void)echo_.ask();
    if (round_trip_ms_ && *round_trip_ms_ > slow_round_trip_ms && now - warned_ > warn_interval) {
        warned_ = now;
        spdlog::warn(
            "the round trip to the server takes {:.0f} ms: beyond {:.0f} ms walls feel late and soft; use a "
            "faster link, or a device at the server's site",
            *round_trip_ms_, slow_round_trip_ms);
    }
}

bool Program::should_end() {
    if (ended_.empty()) {
        if (stop_requested()) {
            ended_ = "interrupted";
        } else if (link_.finished()) {
            ended_ = "session finished";
        } else if (options_.duration > 0.0 && seconds() >= options_.duration) {
            ended_ = "duration";
        }
        if (!ended_.empty()) {
            service_.ending();
        }
    }
    return !ended_.empty();
}

double Program::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

}  // namespace eti::devices
