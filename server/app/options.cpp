// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/options.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/bus/command_line.hpp"
#include "server/app/describe.hpp"

namespace eti::app {

std::optional<int> parse(int argc, char** argv, Options& options) {
    CLI::App app("The physics server: simulates the patient, measures the attempt, publishes the scene.",
                 "eti-server");
    app.set_version_flag("--version", ETI_VERSION);
    app.add_option(
           "--scenario", options.scenarios,
           "Scenario by name or path; given several times: one session after another, the next one when "
           "the command 'next' comes or a session has ended. Their records are FILE, FILE-2, ...")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->capture_default_str();
    app.add_option("--operator", options.operator_name,
                   "Scripted operator by name or path; without it the hands come over the bus");
    app.add_option("--record", options.record, "Write the session to this file (*.eti.h5)")
        ->check([](const std::string& file) {
            return file.empty()
                       ? std::string("names no file; give one, or leave the option out to record nothing")
                       : std::string();
        });
    app.add_option("--participant", options.participant,
                   "Pseudonym of who is trained, for the session file; no name that says who it is");
    bus::add_options(app, options.bus);
    app.add_flag("--fast", options.fast, "Simulate as fast as possible instead of by the clock");
    app.add_flag("!--no-dds", options.with_bus, "Run without the bus");
    app.add_flag("--json", options.json, "Print the result as one JSON object");
    app.add_flag("--finish-after-attempt", options.finish_after_attempt,
                 "End the session two seconds after an attempt has ended");
    app.add_option("--steps", options.steps, "End after this many steps of 1/180 s");
    app.add_option("--duration", options.duration, "End after this simulation time [s]")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--seed", options.seed, "Seed of tremor and chance, instead of the scenario's");
    app.add_option("--threads", options.threads, "Solver threads; 0: one per core; the result is the same")
        ->check(CLI::Range(0, 256));
    bool describe = false;
    app.add_flag("--describe", describe,
                 "Print as JSON what scenarios set, commands change and results hold, with units and ranges");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (describe) {
        std::cout << description().dump(2) << std::endl;
        return 0;
    }
    return std::nullopt;
}

}  // namespace eti::app
