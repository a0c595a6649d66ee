// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/accuracy.hpp"

#include <spdlog/spdlog.h>

#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/bench/server/accuracy/block_cases.hpp"

namespace eti::bench {

namespace {

std::vector<BodySettings> settings(bool quick) {
    std::vector<BodySettings> list;
    const std::vector<double> cells = quick ? std::vector{5e-3} : std::vector{5e-3, 2.5e-3, 1.25e-3};
    const std::vector<int> counts = quick ? std::vector{4, 8} : std::vector{1, 2, 4, 8, 16};
    for (const double cell : cells) {
        for (const int n : counts) {
            list.push_back({Method::shape_matching_pbd, cell, 1, n});
            for (const Method clusters : {Method::shape_matching_xpbd, Method::clusters_for_traction,
                                          Method::clusters_for_indentation, Method::clusters_for_tongue}) {
                BodySettings as_shipped{clusters, cell, n, 1};
                as_shipped.cluster_radius = test::patient_radius;
                list.push_back(as_shipped);
            }
            list.push_back({Method::tetrahedra, cell, n, 1});
            // Explicit steps must be short: start where the other methods do well, and continue from there.
            list.push_back({Method::mass_springs, cell, 2 * n, 1});
        }
    }
    return list;
}

void press_blocks(AccuracyTable& table, Table& forces, bool quick) {
    const std::vector<BodySettings> all = settings(quick);
    for (const auto& block : block_cases(quick)) {
        for (const BodySettings& setting : all) {
            if (!block->fits(setting) || !table.shard().claim_next()) {
                continue;
            }
            const std::string name = block->name();
            const std::string_view method = name_of(setting.method);
            const CaseResult outcome = block->run(setting);
            table.add({name, method, setting.cell, setting.substeps, setting.iterations, outcome.particles,
                       outcome.error, outcome.frame_ms});
            for (const ForceSample& p : outcome.curve) {
                forces.row(fmt::format("{},\"{}\",{:g},{},{},{:g},{:.6g},{:.6g}", name, method,
                                       1e3 * setting.cell, setting.substeps, setting.iterations,
                                       1e3 * p.depth, p.force, p.expected));
            }
        }
        spdlog::info("{} done", block->name());
    }
}

using Group = void (*)(AccuracyTable&, Table&, bool);
constexpr std::pair<const char*, Group> groups[] = {
    {"tube", [](AccuracyTable& table, Table&, bool quick) { bend_tubes(table, quick); }},
    {"tongue", press_tongue},
    {"fluid", [](AccuracyTable& table, Table&, bool quick) { pour_water(table, quick); }},
    {"blocks", press_blocks},
};

}  // namespace

std::vector<std::string> accuracy_group_names() {
    std::vector<std::string> names;
    for (const auto& [name, run] : groups) {
        names.emplace_back(name);
    }
    return names;
}

int accuracy(const AccuracyOptions& options) {
    Shard shard = options.shard;
    const std::filesystem::path folder = shard.begin(options.out);
    AccuracyTable table(folder, shard);
    Table forces(folder, "accuracy-forces.csv",
                 "case,method,spacing_mm,substeps,iterations,depth_mm,force_n,reference_n", &shard);
    for (const auto& [name, run] : groups) {
        if (options.only.empty() || options.only == name) {
            run(table, forces, options.quick);
            spdlog::info("{} done", name);
        }
    }
    shard.finish(folder, "accuracy", {{"quick", options.quick ? "yes" : "no"}, {"only", options.only}});
    spdlog::info("wrote {} and {}", table.path().string(), forces.path().string());
    return 0;
}

}  // namespace eti::bench
