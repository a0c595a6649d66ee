// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "tests/bench/devices/haptics.hpp"

int main(int argc, char** argv) {
    // Standard output belongs to the result.
    spdlog::set_default_logger(spdlog::stderr_color_mt("eti-bench-devices"));
    CLI::App app("Benchmarks of the devices: stability, stiffness and timing of the haptic loop.",
                 "eti-bench-devices");
    app.set_version_flag("--version", ETI_VERSION);
    app.require_subcommand(1);
    eti::bench::HapticsOptions options;
    CLI::App* haptics = app.add_subcommand(
        "haptics",
        "The haptic loop: stable stiffness over delay and loss, timing beside a server (ten minutes)");
    haptics->add_option("--out", options.out, "Folder for the tables")->capture_default_str();
    haptics->add_option("--live-seconds", options.live_seconds, "Of the run beside a server; 0: none")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 3600.0));
    haptics->add_flag("--whole-grid", options.whole_grid,
                      "Over the bus to a real server: all delays, losses and stiffnesses, not a corner");
    haptics->add_option("--grid-minutes", options.grid_minutes, "Begin no cell over the bus after this time")
        ->capture_default_str()
        ->check(CLI::Range(0.1, 600.0));
    haptics->add_option("--only", options.only, "One table")
        ->check(CLI::IsMember(eti::bench::haptics_table_names()));
    haptics->add_flag("--quick", options.quick, "A corner of the maps, no run beside a server");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    try {
        return eti::bench::haptics(options);
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}
