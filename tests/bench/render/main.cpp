// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/quality.hpp"
#include "common/process/program.hpp"
#include "tests/bench/render/render_bench.hpp"

int main(int argc, char** argv) {
    eti::CommandLine app("Image quality: measures pictures of scripted attempts against goals.",
                         "eti-bench-render");
    app.require_subcommand(1);
    eti::bench::RenderOptions options;
    bool quick = false;
    eti::CommandLine render =
        app.add_subcommand("render", "Six moments of attempts in every view, against goals (half an hour)");
    render.add_option("--out", options.out, "Folder for table, pictures and contact sheets")
        .capture_default_str();
    const auto scenarios =
        render.add_option("--scenario", options.scenarios, "Scenarios by name or path").capture_default_str();
    const auto operators =
        render.add_option("--operator", options.operators, "Operators by name or path").capture_default_str();
    const eti::NumberLimits<int> side{64, 8192, "pixels"};
    render.add_number("--width", options.width, "Size of the pictures", side).capture_default_str();
    render.add_number("--height", options.height, "Size of the pictures", side).capture_default_str();
    const auto eyes =
        render.add_number("--eyes", options.eyes, "Eye poses for POGO", {0, 100000}).capture_default_str();
    const auto poses =
        render
            .add_number("--poses", options.poses,
                        "Poses of a lens from which open edges and crossing triangles are counted",
                        {0, 100000})
            .capture_default_str();
    const auto costs =
        render.add_number("--costs", options.costs, "Number of timed pictures per view and size", {0, 10000})
            .capture_default_str();
    render.add_flag("--only-costs", options.only_costs, "Only costs, of pictures of --width by --height");
    render
        .add_option("--quality", options.quality,
                    "Quality whose cost is measured (default: chosen by the driver)")
        .check([](const std::string& name) {
            return eti::render::quality_named(name) != nullptr
                       ? std::string{}
                       : name + ": unknown quality; expected low, medium or high";
        });
    render.add_flag("!--no-pictures", options.pictures, "Write only the table");
    const auto golden = render.add_option(
        "--golden", options.golden,
        "Folder of small pictures to compare with: every view when the blade enters and at the best view");
    render.add_flag("--renew", options.renew, "Write these pictures instead of comparing").needs(golden);
    render
        .add_option("--before", options.before,
                    "Folder of an earlier run with the same scenarios and operators: writes its pictures and "
                    "these side by side, into before_after in --out")
        .existing_folder();
    render.add_flag("--quick", quick,
                    "The expert on the term newborn, forty eye poses, twelve of a lens, no costs");
    const auto work = [&] {
        if (quick) {
            if (scenarios.empty()) {
                options.scenarios = {"term"};
            }
            if (operators.empty()) {
                options.operators = {"expert"};
            }
            if (costs.empty()) {
                options.costs = 0;
            }
            if (eyes.empty()) {
                options.eyes = 40;
            }
            if (poses.empty()) {
                options.poses = 12;
            }
        }
        return eti::bench::render_bench(options);
    };
    return eti::run_program(app, argc, argv, work, eti::StopSignals{.second_ends = true});
}
