// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/options.hpp"

#include <algorithm>
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
    CommandLine app("The physics server: simulates the patient, measures attempts, publishes the scene.",
                    "eti-server");
    app.add_option("--scenario", options.scenarios,
                   "Scenario by name or path; if repeated, sessions run one after another, the next one on "
                   "the command 'next' or when a session has ended. Recordings are FILE, FILE-2, ...")
        .repeatable()
        .capture_default_str();
    const Option hands =
        app.add_option("--operator", options.operator_name,
                       "Scripted operator by name or path; without it, tool poses are received over the bus");
    app.add_number(
           "--operator-skill", options.skill,
           "Skill of the operator; deviations from the script follow from --seed; 1: exactly as scripted",
           {0, 1})
        .needs(hands);
    app.add_number("--operator-attempts", options.attempts,
                   "Maximum number of attempts until the trachea is intubated", {1, max_attempts})
        .needs(hands);
    app.add_option("--record", options.record, "Write the session to this file (*.eti.h5)")
        .check([](const std::string& file) {
            return file.empty()
                       ? std::string("is empty; give a file name, or omit the option to record nothing")
                       : std::string();
        });
    app.add_option("--participant", options.participant,
                   "Pseudonym of the trainee, for the session file; not a real name");
    bus::add_options(app, options.bus);
    app.add_flag("--fast", options.fast, "Simulate as fast as possible instead of in real time");
    app.add_flag("!--no-dds", options.with_bus, "Run without the bus");
    app.add_flag("--json", options.json, "Print the result as one JSON object");
    app.add_flag("--finish-after-attempt", options.finish_after_attempt,
                 "End the session two seconds after the end of an attempt");
    app.add_flag("--loop", options.loop,
                 "With --replay or --operator: restart at the end, with the patient reset to rest")
        .excludes({"--finish-after-attempt"});
    app.add_number("--steps", options.steps, "End after this many steps of 1/180 s", {1, max_steps, "steps"});
    app.add_number("--duration", options.duration, "End after this simulation time; 0: no limit",
                   {0.0, longest_time, "s"});
    app.add_number("--seed", options.seed,
                   "Seed of tremor and other random values, instead of the scenario's", {0});
    app.add_number(
        "--threads", options.threads,
        "Solver threads; 0: as many as the processors that affinity and a container's quota leave to this "
        "process, divided by the number of simulations on them; the result is independent of it",
        {0, 256});
    std::string quality(name_of(options.quality));
    app.add_option("--quality", quality,
                   "auto: in real time, full if this machine keeps up with it, else reduced; with --fast or "
                   "--no-dds full. full: as the scenario says. reduced: half its substeps. The session file "
                   "and --json name it")
        .one_of({quality_names.begin(), quality_names.end()})
        .capture_default_str();
    const Option resimulate =
        app.add_option("--resimulate", options.resimulate,
                       "Simulate the recorded inputs of this session file again, as fast as possible, and "
                       "compare every step with the recording. Exit status 0 only if all are identical")
            .excludes(
                {"--scenario", "--operator", "--seed", "--finish-after-attempt", "--duration", "--quality"});
    app.add_option("--set", options.settings,
                   "With --resimulate: change a value with KEY=VALUE, and show both results side by side. A "
                   "key of eti-controller --set (tissue_stiffness_kpa) applies throughout; a key of a "
                   "scenario (patient.weight_kg, saliva) applies at the start")
        .repeatable()
        .needs(resimulate);
    const Option replay =
        app.add_option("--replay", options.replay.file,
                       "Publish this session file as if it were live; see eti-review replay")
            .excludes({"--scenario", "--operator", "--seed", "--finish-after-attempt", "--duration",
                       "--record", "--fast", "--no-dds", "--steps", "--resimulate", "--quality"});
    app.add_number("--speed", options.replay.speed, "Speed of the replay",
                   {1.0 / 16, 16.0, "times real time"})
        .needs(replay);
    app.add_number("--from", options.replay.from, "Start time of the replay", {0.0, longest_time, "s"})
        .needs(replay);
    app.add_number("--to", options.replay.to, "End time of the replay", {0.0, longest_time, "s"})
        .needs(replay);
    app.add_flag("--pause", options.replay.pause, "Start the replay paused").needs(replay);
    app.callback([&] {
        if (options.loop && options.operator_name.empty() && options.replay.file.empty()) {
            throw UsageError("--loop requires --operator or --replay");
        }
    });
    bool describe = false;
    app.add_flag(
        "--describe", describe,
        "Print the keys of scenarios, runtime parameters and metrics as JSON, with units and ranges");
    if (const auto code = app.parse(argc, argv)) {
        return *code;
    }
    options.quality = static_cast<Quality>(std::ranges::find(quality_names, quality) - quality_names.begin());
    if (describe) {
        std::cout << description().dump(2) << std::endl;
        return 0;
    }
    return std::nullopt;
}

}  // namespace eti::app
