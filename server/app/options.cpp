// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/options.hpp"

#include <iostream>

#include "common/bus/command_line.hpp"
#include "common/operator/operator.hpp"
#include "common/process/command_line.hpp"
#include "server/app/output/describe.hpp"

namespace eti::app {

namespace {

// Longer than any session: half a year.
constexpr double longest_time = 180.0 * 24 * 3600;  // [s]
constexpr std::uint64_t max_steps = 180 * static_cast<std::uint64_t>(longest_time);

}  // namespace

std::optional<int> parse(int argc, char** argv, Options& options) {
    CommandLine app("The physics server: simulates the patient, measures the attempt, publishes the scene.",
                    "eti-server");
    app.add_option(
           "--scenario", options.scenarios,
           "Scenario by name or path; given several times: one session after another, the next one when "
           "the command 'next' comes or a session has ended. Their records are FILE, FILE-2, ...")
        .repeatable()
        .capture_default_str();
    const Option hands =
        app.add_option("--operator", options.operator_name,
                       "Scripted operator by name or path; without it the hands come over the bus");
    app.add_number("--operator-skill", options.skill,
                   "How well it plays its script, from --seed; 1: as it is written", {0, 1})
        .needs(hands);
    app.add_number("--operator-attempts", options.attempts,
                   "How often it tries at most, while the tube does not lie in the trachea",
                   {1, max_attempts})
        .needs(hands);
    app.add_option("--record", options.record, "Write the session to this file (*.eti.h5)")
        .check([](const std::string& file) {
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
    app.add_flag("--loop", options.loop,
                 "With --replay or --operator: begin again at the end, with the patient put back to rest")
        .excludes({"--finish-after-attempt"});
    app.add_number("--steps", options.steps, "End after this many steps of 1/180 s", {1, max_steps, "steps"});
    app.add_number("--duration", options.duration, "End after this simulation time; 0: no limit",
                   {0.0, longest_time, "s"});
    app.add_number("--seed", options.seed, "Seed of tremor and chance, instead of the scenario's", {0});
    app.add_number("--threads", options.threads, "Solver threads; 0: one per core; the result is the same",
                   {0, 256});
    const Option resimulate =
        app.add_option("--resimulate", options.resimulate,
                       "Run the recorded inputs of this session file again, as fast as possible, and compare "
                       "every step with the record. Exit status 0 only if all came out the same")
            .excludes({"--scenario", "--operator", "--seed", "--finish-after-attempt", "--duration"});
    app.add_option("--set", options.settings,
                   "With --resimulate: KEY=VALUE that was otherwise, and both results side by side. A key of "
                   "eti-controller --set (tissue_stiffness_kpa) holds throughout; one of a scenario "
                   "(patient.weight_kg, saliva) holds at the start")
        .repeatable()
        .needs(resimulate);
    const Option replay =
        app.add_option("--replay", options.replay.file,
                       "Publish what this session file holds as if it went on now; see eti-review replay")
            .excludes({"--scenario", "--operator", "--seed", "--finish-after-attempt", "--duration",
                       "--record", "--fast", "--no-dds", "--steps", "--resimulate"});
    app.add_number("--speed", options.replay.speed, "Of the replay", {1.0 / 16, 16.0, "times real time"})
        .needs(replay);
    app.add_number("--from", options.replay.from, "Where the replay begins", {0.0, longest_time, "s"})
        .needs(replay);
    app.add_number("--to", options.replay.to, "Where the replay ends", {0.0, longest_time, "s"})
        .needs(replay);
    app.add_flag("--pause", options.replay.pause, "Begin the replay paused").needs(replay);
    app.callback([&] {
        if (options.loop && options.operator_name.empty() && options.replay.file.empty()) {
            throw UsageError("--loop requires --operator or --replay");
        }
    });
    bool describe = false;
    app.add_flag("--describe", describe,
                 "Print as JSON what scenarios set, commands change and results hold, with units and ranges");
    if (const auto code = app.parse(argc, argv)) {
        return *code;
    }
    if (describe) {
        std::cout << description().dump(2) << std::endl;
        return 0;
    }
    return std::nullopt;
}

}  // namespace eti::app
