// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <cmath>

#include "server/app/simulation.hpp"
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
    }
    const LiftReference reference(scenario, patient, surroundings, choice);
    spdlog::info(
        "lift: finite elements {:.2f} N, view {:.1f} %; {} increments, {} iterations, {:.1g} mm deep",
        reference.lift.force.norm(), reference.lift.opening, reference.increments, reference.iterations,
        1e3 * reference.penetration);
    for (const auto& [model, method] : {std::pair{TissueModel::clusters, Method::clusters_for_tongue},
                                        std::pair{TissueModel::tetrahedra, Method::tetrahedra}}) {
        for (const int substeps : quick ? std::vector{8} : std::vector{6, 8, 12, 16, 24}) {
            scenario.physics.tissue_model = model;
            scenario.physics.substeps = substeps;
            const Lift found = by_particles(scenario, patient, way, reference.free());
            const Vec3d material = reference.material(found);
            spdlog::info(
                "lift: {}, {} substeps: told {:.2f} N, material {:.2f} N, view {:.1f} %, still {:.1f} mm/s",
                name_of(method), substeps, found.force.norm(), material.norm(), found.opening,
                1e3 * found.speed);
            const auto add = [&](std::string_view name, double error) {
                table.add({name, name_of(method), static_cast<double>(scenario.physics.spacing), substeps, 1,
                           found.position.size(), error, found.frame_ms});
            };
            const double expected = reference.lift.force.norm();
            add("lift-force", (found.force - reference.lift.force).norm() / expected);
            add("lift-material", (material - reference.lift.force).norm() / expected);
            add("lift-shape", reference.apart(found));
            add("lift-view", std::fabs(found.opening - reference.lift.opening) / 100.0);
            add("lift-still", 1e3 * found.speed);
        }
    }
}

}  // namespace eti::bench
