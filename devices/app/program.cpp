// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/program.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <thread>

#include "common/scenario/scenario.hpp"

namespace eti::devices {

namespace {

volatile std::sig_atomic_t stop_requested = 0;

constexpr std::chrono::milliseconds look_for_server{1000};
constexpr std::chrono::milliseconds poll_interval{20};

std::optional<OperatorScript> script_of(const ProgramOptions& options) {
    if (options.operator_name.empty()) {
        return std::nullopt;
    }
    return load_operator(find_data_file(options.operator_name, "operators"));
}

}  // namespace

void add_options(CLI::App& app, ProgramOptions& options, Tool tool) {
    std::string known;
    for (const Driver& driver : drivers()) {
        if (driver.tool == tool) {
            known += fmt::format("{}{}: {}", known.empty() ? "" : "; ", driver.name, driver.description);
        }
    }
    app.set_version_flag("--version", ETI_VERSION);
    app.add_option("--device", options.device, known)->required();
    app.add_option("--operator", options.operator_name,
                   "Scripted hand by name or path; without it the device is held still");
    app.add_option("--session", options.bus.session, "Session to join")->capture_default_str();
    app.add_option("--domain", options.bus.domain, "DDS domain")->capture_default_str();
    app.add_option("--profile", options.bus.profile, "Fast DDS XML profile file (see deploy/dds)");
    app.add_option("--duration", options.duration, "End after this time [s]; else when the session ends")
        ->check(CLI::PositiveNumber);
    app.add_flag("--json", options.json, "Print the statistics as one JSON object");
}

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    return std::nullopt;
}

void set_up_process(const std::string& name) {
    spdlog::set_default_logger(spdlog::stderr_color_mt(name));
    std::signal(SIGINT, [](int) { stop_requested = 1; });
    std::signal(SIGTERM, [](int) { stop_requested = 1; });
}

Program::Program(const ProgramOptions& options, Tool tool)
    : options_(options),
      tool_(tool),
      driver_(driver_named(options.device, tool)),
      script_(script_of(options)),
      started_(std::chrono::steady_clock::now()),
      node_(options.bus),
      link_(node_, tool == Tool::laryngoscope) {
    for (const std::string& warning : bus::self_check(node_, false, look_for_server).warnings) {
        spdlog::warn("{}", warning);
    }
}

std::unique_ptr<Sensor> Program::open_sensor() {
    SensorSetup setup;
    setup.tool = tool_;
    setup.script = script_;
    if (script_) {
        spdlog::info("'{}' waits for the scene of session '{}' on domain {}", script_->name,
                     options_.bus.session, options_.bus.domain);
        std::optional<Surroundings> around;
        while (!(around = link_.surroundings())) {
            if (should_end()) {
                return nullptr;
            }
            std::this_thread::sleep_for(poll_interval);
        }
        setup.start = around->seen;
        setup.tool_length = tool_ == Tool::tube ? around->grip_to_tip : around->blade_length;
        setup.curvature = tool_ == Tool::tube ? around->tube_curvature : 0.0f;
    }
    spdlog::info("device '{}' in session '{}'{}", driver_.name, options_.bus.session,
                 script_ ? ", moved by '" + script_->name + "'" : ", held still");
    return driver_.open(setup);
}

bool Program::should_end() {
    if (ended_.empty()) {
        if (stop_requested != 0) {
            ended_ = "interrupted";
        } else if (link_.finished()) {
            ended_ = "session finished";
        } else if (options_.duration > 0.0 && seconds() >= options_.duration) {
            ended_ = "duration";
        }
    }
    return !ended_.empty();
}

double Program::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
}

}  // namespace eti::devices
