// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/stability/stability.hpp"

#include <spdlog/spdlog.h>

#include "common/model/pace.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

using Part = std::pair<std::string, void (*)(const Sweep&, StabilityTable&)>;

const std::vector<Part>& stability_parts() {
    static const std::vector<Part> parts = {{"blocks", blocks_thrown_and_released},
                                            {"sets", degenerate_and_conflicting_sets},
                                            {"blade", blade_into_tissue_on_bone},
                                            {"walls", tools_against_thin_walls},
                                            {"scene", head_in_one_step},
                                            {"fluid", fluid_in_a_closing_gap}};
    return parts;
}

}  // namespace

std::vector<std::string> stability_part_names() {
    std::vector<std::string> names;
    for (const Part& part : stability_parts()) {
        names.push_back(part.first);
    }
    return names;
}

int stability(const StabilityOptions& options) {
    Shard shard = options.shard;
    const std::filesystem::path folder = shard.begin(options.out);
    StabilityTable maps(folder, shard);
    Sweep sweep{.quick = options.quick};
    if (options.quick) {
        sweep.methods = {Method::shape_matching_xpbd, Method::hexahedra_implicit};
        sweep.rates = {shipped_rate()};
        sweep.solves = {1};
    }
    for (const auto& [name, add] : stability_parts()) {
        if (options.only.empty() || options.only == name) {
            add(sweep, maps);
            spdlog::info("{}: done", name);
        }
    }
    shard.finish(folder, "stability", {{"quick", options.quick ? "yes" : "no"}, {"only", options.only}});
    spdlog::info(
        "wrote {}; the scenarios ship implicit hexahedra, one solve per {}, and clusters, XPBD, at {}",
        maps.path().string(), step_name(steps_per_second), step_name(shipped_rate()));
    return 0;
}

}  // namespace eti::bench
