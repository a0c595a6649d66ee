// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <tbb/global_control.h>

#include "common/process/program.hpp"
#include "common/process/threads/processors.hpp"
#include "tests/bench/server/accuracy/accuracy.hpp"
#include "tests/bench/server/accuracy/calibration.hpp"
#include "tests/bench/server/matter/matter.hpp"
#include "tests/bench/server/shard.hpp"
#include "tests/bench/server/speed/sleep.hpp"
#include "tests/bench/server/speed/speed.hpp"
#include "tests/bench/server/stability/stability.hpp"
#include "tests/bench/server/stability/sufficiency.hpp"

int main(int argc, char** argv) {
    eti::CommandLine app("Benchmarks of the physics: charts and tables that decide the shipped settings.",
                         "eti-bench-physics");
    app.require_subcommand(1);
    int threads = 0;
    app.add_number("--threads", threads, "Solver threads; 0: one per core (speed: one, then two)", {0, 256});

    eti::bench::SufficiencyOptions sufficiency;
    eti::CommandLine shrink = app.add_subcommand(
        "sufficiency",
        "Outcome of a scripted intubation over the resolution of the model (a quarter of an hour)");
    shrink.add_option("--out", sufficiency.out, "Folder for the table").capture_default_str();
    shrink.add_option("--scenario", sufficiency.scenarios, "Scenarios by name or path").capture_default_str();
    shrink
        .add_number("--seeds", sufficiency.seeds, "Runs of the shipped model, for the tremor's scatter",
                    {1, 100})
        .capture_default_str();
    shrink.add_flag("--quick", sufficiency.quick, "Two variants only");
    eti::bench::AccuracyOptions accuracy;
    eti::CommandLine errors =
        app.add_subcommand("accuracy", "Error against cost of every method, in cases with a reference");
    errors.add_option("--out", accuracy.out, "Folder for the table").capture_default_str();
    errors.add_flag("--quick", accuracy.quick, "A small part of the sweep");
    errors.add_option("--only", accuracy.only, "One group of cases")
        .one_of(eti::bench::accuracy_group_names());
    eti::bench::CalibrationOptions calibration;
    eti::CommandLine moduli =
        app.add_subcommand("calibration", "Measured modulus of bodies of clusters over the input modulus");
    moduli.add_option("--out", calibration.out, "Folder for the table").capture_default_str();
    moduli.add_flag("--quick", calibration.quick, "A small part of the sweep");
    eti::bench::StabilityOptions stability;
    eti::CommandLine limits =
        app.add_subcommand("stability", "Where every method survives, recovers or fails");
    limits.add_option("--out", stability.out, "Folder for the table").capture_default_str();
    limits.add_flag("--quick", stability.quick, "The shipped methods and substep only");
    limits.add_option("--only", stability.only, "One part of the maps")
        .one_of(eti::bench::stability_part_names());
    std::string shard;
    for (eti::CommandLine sweep : {shrink, errors, limits}) {
        sweep.add_option("--shard", shard,
                         "I/N, such as 0/4 to 3/4: only a share of the runs, into OUT/shard-I-of-N; 'merge' "
                         "combines the shares");
    }
    std::filesystem::path merged;
    std::vector<std::filesystem::path> shares;
    eti::CommandLine together =
        app.add_subcommand("merge", "Merge the tables of a sweep's shards, as written by one process");
    together.add_option("out", merged, "Folder for the tables").required();
    together.add_option("shards", shares, "Folders of all shards").required().existing_folder();
    eti::bench::SpeedOptions speed;
    eti::CommandLine costs =
        app.add_subcommand("speed", "Cost of the solver's parts, with one thread and two, or with --threads");
    costs.add_flag("--json", speed.json, "Print one JSON object");
    costs.add_flag("--quick", speed.quick, "Fewer repetitions");
    costs.add_flag("--sweeps", speed.sweeps, "Only the scene's steps while posture and tissue change");
    eti::bench::SleepOptions sleep;
    eti::CommandLine resting = app.add_subcommand(
        "sleep", "Effect of sleeping tissue on an attempt, and its savings per step (three minutes)");
    resting.add_option("--out", sleep.out, "Folder for the tables").capture_default_str();
    resting.add_option("--scenario", sleep.scenarios, "Scenarios by name or path").capture_default_str();
    resting.add_flag("--quick", sleep.quick, "Two seconds of the attempt, with the shipped model");
    eti::bench::MatterOptions matter;
    eti::CommandLine lift = app.add_subcommand(
        "matter",
        "Volume, forces, view and rest of the tissue in a replayed lift of the blade, and blocks against "
        "independent references");
    lift.add_option("--scenario", matter.scenarios, "Scenarios by name").capture_default_str();
    lift.add_option("--method", matter.methods, "Tissue methods instead of the scenarios'");
    lift.add_option("--path", matter.path, "Poses of the blade, instead of the committed ones");
    lift.add_option("--record", matter.record,
                    "Write the expert's lift of the first scenario to this file, and end");
    lift.add_option("--out", matter.out,
                    "Repeat the lifts with fixed bones, without relaxation and with other resolutions, and "
                    "write tables to this folder");
    lift.add_option("--trace", matter.trace, "Write values over time to this file");
    lift.add_number("--substeps", matter.substeps, "Instead of the scenarios'", {0, 64});
    lift.add_number("--spacing", matter.spacing, "Spacing of particles [mm] instead of the scenarios'",
                    {0, 5});
    lift.add_number("--fine-spacing", matter.fine_spacing, "The same at epiglottis and larynx", {0, 2});
    lift.add_flag("--plate", matter.plate,
                  "The epiglottis as a plate with rows of its own, its links in the solve (under trial)");
    lift.add_flag("--fixed-bones", matter.fixed_bones, "Head, mandible and hyoid do not yield");
    lift.add_flag("--elastic", matter.elastic, "The stress of tongue and epiglottis does not relax");
    lift.add_flag("--no-blocks", matter.no_blocks, "Lifts only");
    lift.add_flag("--quick", matter.quick, "The first scenario and few blocks (two minutes)");
    lift.add_flag("--json", matter.json, "Print one JSON object");
    return eti::run_program(
        app, argc, argv,
        [&] {
            const tbb::global_control control(
                tbb::global_control::max_allowed_parallelism,
                threads > 0 ? static_cast<std::size_t>(threads) : eti::usable_processors());
            if (!shard.empty()) {
                accuracy.shard = stability.shard = sufficiency.shard = eti::bench::Shard(shard);
            }
            if (together.parsed()) {
                return eti::bench::merge(merged, shares);
            }
            if (errors.parsed()) {
                return eti::bench::accuracy(accuracy);
            }
            if (moduli.parsed()) {
                return eti::bench::calibration(calibration);
            }
            if (resting.parsed()) {
                return eti::bench::sleep(sleep);
            }
            if (lift.parsed()) {
                return eti::bench::matter(matter);
            }
            if (costs.parsed()) {
                if (threads > 0) {
                    speed.threads = {threads};
                }
                return eti::bench::speed(speed);
            }
            return limits.parsed() ? eti::bench::stability(stability) : eti::bench::sufficiency(sufficiency);
        },
        std::nullopt);
}
