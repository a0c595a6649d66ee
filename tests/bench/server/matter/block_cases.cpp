// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/block_cases.hpp"

#include <cmath>

#include "tests/bench/server/accuracy/block_cases.hpp"

namespace eti::bench {

namespace {

void append(std::string_view name, const BodySettings& setting, nlohmann::ordered_json& out) {
    for (const BlockLoad& load : run_block(name, setting).loads) {
        nlohmann::ordered_json row = {
            {"case", name},
            {"element", setting.method == Method::tetrahedra_implicit ? "tetrahedra" : "hexahedra"},
            {"nu", setting.poisson_ratio},
            {"cell_mm", 1e3 * setting.cell},
            {"depth_mm", load.depth_mm},
            {"value", load.value},
            {"reference", load.reference},
            {"error", load.value / load.reference - 1.0},
            {"steps_to_rest", load.steps}};
        if (!std::isnan(load.shape_error)) {
            row["shape_error"] = load.shape_error;
        }
        out.push_back(std::move(row));
    }
}

}  // namespace

nlohmann::ordered_json reference_blocks(bool quick) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    std::vector<Method> methods = {Method::hexahedra_implicit};
    if (!quick) {
        methods.insert(methods.begin(), Method::tetrahedra_implicit);
    }
    for (const Method method : methods) {
        for (const double nu : {0.45, 0.49}) {
            // Damped as little as the scene's tongue.
            BodySettings setting = {
                .method = method, .substeps = 1, .iterations = 8, .poisson_ratio = nu, .damping = 20.0};
            append("bar", setting, out);
            append("sphere", setting, out);
            for (const double cell : {2.5e-3, 2e-3, 1.25e-3}) {
                if (!quick || cell == 2e-3) {
                    setting.cell = cell;
                    append("blade", setting, out);
                }
            }
        }
    }
    return out;
}

}  // namespace eti::bench
