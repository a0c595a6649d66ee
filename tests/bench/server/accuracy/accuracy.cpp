// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/accuracy.hpp"

#include <spdlog/spdlog.h>

#include <cmath>

#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/bench/server/accuracy/block_cases.hpp"

namespace eti::bench {

namespace {

constexpr double tissue_ratio = 0.49;  // Poisson's, of the scenes' tongue

/// Each method with cells of increasing fineness, and with increasing work in each step.
std::vector<BodySettings> settings(bool quick) {
    std::vector<BodySettings> list;
    for (const double cell : quick ? std::vector{5e-3} : std::vector{5e-3, 2.5e-3, 1.25e-3}) {
        for (const int n : quick ? std::vector{8} : std::vector{4, 8, 16}) {
            for (const Method implicit : {Method::hexahedra_implicit, Method::tetrahedra_implicit}) {
                list.push_back({.method = implicit, .cell = cell, .substeps = 1, .iterations = n});
            }
            list.push_back(
                {.method = Method::shape_matching_pbd, .cell = cell, .substeps = 1, .iterations = n});
            for (const Method clusters : {Method::shape_matching_xpbd, Method::clusters_for_traction,
                                          Method::clusters_for_indentation, Method::clusters_for_tongue}) {
                list.push_back({.method = clusters,
                                .cell = cell,
                                .substeps = n,
                                .cluster_radius = test::patient_radius});
            }
            // Explicit steps must be short: start where the other methods do well, and continue from there.
            list.push_back({.method = Method::mass_springs, .cell = cell, .substeps = 2 * n});
        }
    }
    for (BodySettings& setting : list) {
        setting.poisson_ratio = tissue_ratio;
    }
    return list;
}

/// Whether cells of this size resolve a case: the sphere's block is large, the blade's small.
bool resolves(std::string_view name, double cell) {
    return name == "bar" || (name == "sphere" ? cell > 2e-3 : cell < 3e-3);
}

/// RMS over the loads.
template <typename Error>
double rms(const std::vector<BlockLoad>& loads, const Error& error) {
    double squared = 0.0;
    for (const BlockLoad& load : loads) {
        squared += std::pow(error(load), 2);
    }
    return std::sqrt(squared / static_cast<double>(loads.size()));
}

void press_blocks(AccuracyTable& table, Table& forces, bool quick) {
    for (const std::string_view name : block_cases) {
        for (const BodySettings& setting : settings(quick)) {
            if (!resolves(name, setting.cell) || !table.shard().claim_next()) {
                continue;
            }
            const std::string_view method = name_of(setting.method);
            const BlockOutcome outcome = run_block(name, setting);
            const auto add = [&](std::string_view as, double error) {
                table.add({as, method, setting.cell, setting.substeps, setting.iterations, outcome.particles,
                           error, outcome.frame_ms});
            };
            add(name, rms(outcome.loads, [](const BlockLoad& l) { return l.value / l.reference - 1.0; }));
            if (!std::isnan(outcome.loads.front().shape_error)) {
                add("blade-shape", rms(outcome.loads, [](const BlockLoad& l) { return l.shape_error; }));
            }
            for (const BlockLoad& l : outcome.loads) {
                forces.row(fmt::format("{},\"{}\",{:g},{},{},{:g},{:.6g},{:.6g}", name, method,
                                       1e3 * setting.cell, setting.substeps, setting.iterations, l.depth_mm,
                                       l.value, l.reference));
            }
        }
        spdlog::info("{} done", name);
    }
}

using Group = void (*)(AccuracyTable&, Table&, bool);
constexpr std::pair<const char*, Group> groups[] = {
    {"tube", [](AccuracyTable& table, Table&, bool quick) { bend_tubes(table, quick); }},
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
                 "case,method,spacing_mm,substeps,iterations,depth_mm,value,reference", &shard);
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
