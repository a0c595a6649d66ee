// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <sstream>

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
    if (std::getenv("ETI_DEV") != nullptr) {
        spdlog::set_level(spdlog::level::debug);
    }
    const auto reference_with = [&](const LiftChoice& c) {
        LiftReference out(scenario, patient, surroundings, c);
        spdlog::info("lift: finite elements, drag {:g}: {:.3f} N, view {:.1f} %; {} steps, {} iterations",
                     c.drag, out.lift.force.norm(), out.lift.opening, out.increments, out.iterations);
        return out;
    };
    const LiftReference reference = reference_with(choice);
    struct Row {
        TissueModel model;
        Method method;
        int substeps, iterations;
    };
    std::vector<Row> rows;
    const auto add_rows = [&](TissueModel model, Method method, int iterations,
                              const std::vector<int>& counts) {
        for (const int substeps : counts) {
            rows.push_back({model, method, substeps, iterations});
        }
    };
    const std::vector<int> shipped = {8};
    add_rows(TissueModel::clusters, Method::clusters_for_tongue, 1, quick ? shipped : std::vector{8, 16, 24});
    // With fewer than five the scene refuses the term patient's tetrahedra.
    add_rows(TissueModel::tetrahedra, Method::tetrahedra, 1,
             quick ? shipped : std::vector{5, 6, 8, 12, 16, 24, 32});
    // Substeps of what lies about the tongue.
    add_rows(TissueModel::implicit, Method::tetrahedra_implicit,
             pbd::ImplicitTetrahedra::Settings{}.iterations, quick ? shipped : std::vector{4, 8, 16});
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
    Table variants(
        table.path().parent_path(), "lift-reference.csv",
        "drag,increment_mm,force_n,force_difference,shape_difference,view_percent,steps,iterations");
    const auto write = [&](const LiftChoice& c, const LiftReference& of) {
        variants.row(fmt::format("{:g},{:g},{:.5g},{:.4g},{:.4g},{:.4g},{},{}", c.drag, 1e3 * c.increment,
                                 of.lift.force.norm(),
                                 (of.lift.force - reference.lift.force).norm() / reference.lift.force.norm(),
                                 reference.apart(of.lift), of.lift.opening, of.increments, of.iterations));
    };
    write(choice, reference);
    LiftChoice slower = choice;
    slower.drag = 4.0;
    write(slower, reference_with(slower));
}

}  // namespace eti::bench
