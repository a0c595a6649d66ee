// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "common/model/pace.hpp"
#include "common/scenario/scenario.hpp"
#include "server/scene/scene.hpp"
#include "tests/bench/server/accuracy/block_body.hpp"
#include "tests/bench/server/stability/fate.hpp"

namespace eti::bench {

/// Default substeps per second of scenarios.
[[nodiscard]] inline double shipped_rate() {
    return steps_per_second * Scenario::Physics{}.substeps;
}

/// Swept values: everything, or the shipped setting only.
struct Sweep {
    bool quick = false;
    std::vector<Method> methods = {Method::shape_matching_pbd, Method::shape_matching_xpbd,
                                   Method::tetrahedra_implicit, Method::hexahedra_implicit,
                                   Method::mass_springs};
    std::vector<double> rates = {30, 60, 180, 360, 720, 1440, 2000};  ///< substeps per second
    std::vector<int> solves = {1, 2, 4, 8};  ///< of the implicit method per step of the scene
};

[[nodiscard]] inline std::string step_name(double rate) {
    return fmt::format("1/{:g} s", rate);
}

struct Column {
    std::string name;
    double rate = 0.0;  ///< [1/s], of substeps or solves
};

/// Values swept across a panel.
[[nodiscard]] inline std::vector<Column> columns_of(const Sweep& sweep, Method method) {
    std::vector<Column> columns;
    if (is_implicit(method)) {
        for (const int count : sweep.solves) {
            columns.push_back({std::to_string(count), double{steps_per_second} * count});
        }
    } else {
        for (const double rate : sweep.rates) {
            columns.push_back({step_name(rate), rate});
        }
    }
    return columns;
}

/// [1/s], of velocity: a sixteenth of the patient's tissue, so that damping alone makes nothing stable.
inline constexpr double light_damping = 12.0;

/// A block's settings with one pass, or one solve, per step of 1 / `rate` [s].
[[nodiscard]] inline BodySettings with_rate(Method method, double rate,
                                            double youngs_modulus = BodySettings{}.youngs_modulus) {
    return {.method = method,
            .cell = 2.5e-3,
            .substeps = 1,
            .iterations = is_implicit(method) ? pbd::ImplicitMesh::Settings{}.iterations : 1,
            .step = 1.0 / rate,
            .youngs_modulus = youngs_modulus,
            // As in whole cells of the tongue, and in those that its surface cuts.
            .poisson_ratio = method == Method::hexahedra_implicit ? 0.49 : 0.45,
            .damping = light_damping};
}

// Each part adds its maps.
void blocks_thrown_and_released(const Sweep& sweep, StabilityTable& maps);
void degenerate_and_conflicting_sets(const Sweep& sweep, StabilityTable& maps);
void blade_into_tissue_on_bone(const Sweep& sweep, StabilityTable& maps);
void tools_against_thin_walls(const Sweep& sweep, StabilityTable& maps);
void head_in_one_step(const Sweep& sweep, StabilityTable& maps);
void fluid_in_a_closing_gap(const Sweep& sweep, StabilityTable& maps);

}  // namespace eti::bench
