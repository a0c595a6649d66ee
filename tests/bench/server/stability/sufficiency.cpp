// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/stability/sufficiency.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/server/table.hpp"
#include "tests/bench/server/trial.hpp"

namespace eti::bench {

namespace {

using Physics = Scenario::Physics;

/// A model to compare: its differences from the shipped one.
struct Variant {
    std::string name;
    Physics physics;
    bool saliva = false;
};

// The finest model compared: twice the substeps, finer particles, tissue nearly three times as deep.
constexpr Physics richest{.substeps = 16, .spacing = 1.5e-3f, .fine_spacing = 0.8e-3f, .region = 20e-3f};

std::vector<Variant> variants(const Scenario& scenario, bool quick) {
    const Physics& shipped = scenario.physics;
    if (quick) {
        Physics coarse = shipped;
        coarse.substeps = 4;
        return {{"default", shipped, scenario.saliva}, {"substeps 4", coarse, scenario.saliva}};
    }
    std::vector<Variant> list = {{"richest", richest, scenario.saliva},
                                 {"default", shipped, scenario.saliva}};
    const auto with = [&](const std::string& name, auto change) {
        Physics physics = shipped;
        change(physics);
        list.push_back({name, physics, scenario.saliva});
    };
    for (const int substeps : {4, 16}) {
        with(fmt::format("substeps {}", substeps), [&](Physics& p) { p.substeps = substeps; });
    }
    for (const int mm : {10, 15}) {
        with(fmt::format("region {} mm", mm), [&](Physics& p) { p.region = 1e-3f * static_cast<float>(mm); });
    }
    for (const float mm : {1.5f, 2.5f}) {
        with(fmt::format("spacing {} mm", mm), [&](Physics& p) { p.spacing = 1e-3f * mm; });
    }
    for (const float mm : {0.8f, 1.25f}) {
        with(fmt::format("fine spacing {} mm", mm), [&](Physics& p) { p.fine_spacing = 1e-3f * mm; });
    }
    with("tongue of clusters", [](Physics& p) { p.tissue_method = TissueMethod::clusters; });
    return list;
}

void write_row(Table& table, const std::string& scenario, const Variant& v, std::uint64_t seed,
               const TrialResult& t) {
    table.row(fmt::format(
        "{},{},{},{},{:g},{:g},{:g},{},{},{:.2f},{:.2f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f}", scenario,
        v.name, seed, v.physics.substeps, 1e3 * v.physics.spacing, 1e3 * v.physics.fine_spacing,
        1e3 * v.physics.region, t.particles, t.success ? 1 : 0, t.glottic_opening_percent, t.view_percent,
        t.gum_force, t.tongue_force, t.epiglottis_force, t.blade_force, t.time, t.step_ms));
}

}  // namespace

int sufficiency(const SufficiencyOptions& options) {
    Shard shard = options.shard;
    const std::filesystem::path folder = shard.begin(options.out);
    Table table(folder, "sufficiency.csv",
                "scenario,variant,seed,substeps,spacing_mm,fine_spacing_mm,region_mm,particles,success,"
                "glottic_opening_max_percent,glottic_opening_mean_percent,gum_force_max_n,tongue_force_max_n,"
                "epiglottis_force_max_n,blade_force_max_n,time_s,step_ms",
                &shard);
    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    for (const std::string& name : options.scenarios) {
        const Scenario shipped = load_scenario(find_data_file(name, "scenarios"));
        const std::uint64_t seed = shipped.seed ^ script.seed;
        const std::vector<Variant> all = variants(shipped, options.quick);
        for (std::size_t k = 0; k < all.size(); ++k) {
            // The tremor's scatter is that of the shipped model.
            const int seeds = all[k].name == "default" ? std::max(1, options.seeds) : 1;
            for (int s = 0; s < seeds; ++s) {
                if (!shard.claim_next()) {
                    continue;
                }
                Scenario scenario = shipped;
                scenario.physics = all[k].physics;
                scenario.saliva = all[k].saliva;
                TrialResult trial;
                try {
                    trial = perform(scenario, script, seed + static_cast<std::uint64_t>(s));
                } catch (const InputError& refusal) {
                    spdlog::warn("'{}' is excluded: {}", all[k].name, refusal.what());
                    continue;
                }
                write_row(table, shipped.name, all[k], seed + static_cast<std::uint64_t>(s), trial);
                spdlog::info("{} {}/{} '{}': {}, view {:.0f} %, {:.1f} ms a step", shipped.name, k + 1,
                             all.size(), all[k].name, trial.reason, trial.glottic_opening_percent,
                             trial.step_ms);
            }
        }
    }
    shard.finish(folder, "sufficiency",
                 {{"quick", options.quick ? "yes" : "no"},
                  {"scenarios", fmt::format("{}", fmt::join(options.scenarios, ", "))},
                  {"seeds", std::to_string(options.seeds)}});
    spdlog::info("wrote {}", table.path().string());
    return 0;
}

}  // namespace eti::bench
