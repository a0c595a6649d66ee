// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/program.hpp"
#include "tests/bench/devices/haptics.hpp"

int main(int argc, char** argv) {
    eti::CommandLine app("Benchmarks of the devices: stability, stiffness and timing of the haptic loop.",
                         "eti-bench-devices");
    app.require_subcommand(1);
    eti::bench::HapticsOptions options;
    eti::CommandLine haptics = app.add_subcommand(
        "haptics",
        "The haptic loop: stable stiffness over delay and loss, timing beside a server (ten minutes)");
    haptics.add_option("--out", options.out, "Folder for the tables").capture_default_str();
    haptics
        .add_number("--live-seconds", options.live_seconds, "Duration of the run beside a server; 0: none",
                    {0.0, 3600.0, "s"})
        .capture_default_str();
    haptics.add_flag("--whole-grid", options.whole_grid,
                     "Over the bus to a real server: all delays, losses and stiffnesses instead of a few");
    haptics
        .add_number("--grid-minutes", options.grid_minutes, "Start no cell over the bus after this time",
                    {0.1, 600.0, "min"})
        .capture_default_str();
    haptics.add_option("--only", options.only, "Measure only this table")
        .one_of(eti::bench::haptics_table_names());
    haptics.add_flag("--quick", options.quick, "A small part of the maps, no run beside a server");
    return eti::run_program(
        app, argc, argv, [&] { return eti::bench::haptics(options); }, std::nullopt);
}
