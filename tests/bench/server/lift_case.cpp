// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "server/app/simulation.hpp"
#include "server/pbd/implicit_tetrahedra.hpp"
#include "tests/bench/server/accuracy_table.hpp"
#include "tests/bench/server/block_cases.hpp"
#include "tests/bench/server/lift_reference.hpp"

namespace eti::bench {

void lift_tongue(AccuracyTable& table, bool quick) {
    Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    if (quick) {
        scenario.physics.spacing = 2.5e-3f;
    }
    const anatomy::Patient patient = app::patient_of(scenario);
    const std::vector<scene::Inputs> way = lift_of(scenario, patient);
    const Surroundings surroundings = surroundings_of(scenario, patient, way, quick ? 12 : 32);
    LiftChoice choice;
    if (quick) {
        choice.increment = 4e-3;
        choice.longest = 36;
    }
    const LiftReference reference(scenario, patient, surroundings, choice);
    spdlog::info(
        "lift: finite elements {:.2f} N, view {:.1f} %; {} increments, {} iterations, {:.1g} mm deep",
        reference.lift.force.norm(), reference.lift.opening, reference.increments, reference.iterations,
        1e3 * reference.penetration);
    struct Row {
        TissueModel model;
        Method method;
        int substeps, iterations;
    };
    std::vector<Row> rows;
    // With fewer than five the scene refuses the term patient's tetrahedra.
    for (const int substeps : quick ? std::vector{8} : std::vector{5, 6, 8, 12, 16, 24, 32}) {
        rows.push_back({TissueModel::clusters, Method::clusters_for_tongue, substeps, 1});
        rows.push_back({TissueModel::tetrahedra, Method::tetrahedra, substeps, 1});
    }
    for (const int substeps : quick ? std::vector{8} : std::vector{4, 8, 16}) {
        rows.push_back({TissueModel::implicit, Method::tetrahedra_implicit, substeps,
                        pbd::ImplicitTetrahedra::Settings{}.iterations});
    }
    std::ranges::stable_sort(rows, {}, &Row::method);
    for (const Row& row : rows) {
        scenario.physics.tissue_model = row.model;
        scenario.physics.substeps = row.substeps;
        const Lift found = by_particles(scenario, patient, way, reference.free());
        const Vec3d material = reference.material(found);
        const double expected = reference.lift.force.norm();
        const std::pair<std::string_view, double> errors[] = {
            {"lift-force", (found.force - reference.lift.force).norm() / expected},
            {"lift-material", (material - reference.lift.force).norm() / expected},
            {"lift-shape", reference.apart(found)},
            {"lift-view", std::fabs(found.opening - reference.lift.opening) / 100.0},
            {"lift-still", 1e3 * found.speed}};
        spdlog::info(
            "lift: {}, {} substeps: told {:.2f} N, material {:.2f} N, view {:.1f} %, still {:.2f} mm/s",
            name_of(row.method), row.substeps, found.force.norm(), material.norm(), found.opening,
            1e3 * found.speed);
        for (const auto& [name, error] : errors) {
            table.add({name, name_of(row.method), static_cast<double>(scenario.physics.spacing), row.substeps,
                       row.iterations, found.position.size(), error, found.frame_ms});
        }
    }
}

}  // namespace eti::bench
