// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <cmath>

#include "server/app/run/simulation.hpp"
#include "server/pbd/soft/implicit_mesh.hpp"
#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/bench/server/accuracy/block_cases.hpp"
#include "tests/bench/server/accuracy/lift_reference.hpp"

namespace eti::bench {

namespace {

struct LiftSetup {
    Scenario scenario;
    patient::Patient patient;
    std::vector<scene::Inputs> way;
    LiftSettings choice;

    /// `tremor` is added to the scenario's seed.
    explicit LiftSetup(bool quick, std::uint64_t tremor = 0)
        : scenario(load_scenario(find_data_file("term", "scenarios"))) {
        scenario.seed += tremor;
        scenario.physics.sleep = false;  // steady state and cost are measured
        if (quick) {
            scenario.physics.spacing = 3.5e-3f;
            choice.increment = 4e-3;
            choice.longest = 36;
        }
        patient = app::patient_of(scenario);
        way = lift_of(scenario, patient);
    }
    [[nodiscard]] Surroundings surroundings() const { return surroundings_of(scenario, patient, way); }
    [[nodiscard]] LiftReference reference(const Surroundings& surroundings, const LiftSettings& with) const {
        LiftReference out(scenario, patient, surroundings, with);
        spdlog::info("lift: finite elements {:.3f} N, view {:.1f} %; {} steps, {} iterations",
                     out.lift.force.norm(), out.lift.opening, out.increments, out.iterations);
        return out;
    }
};

}  // namespace

void lift_tongue(AccuracyTable& table, bool quick) {
    if (!table.shard().claim_next()) {  // one run: its cost is that of the references
        return;
    }
    const LiftSetup setup(quick);
    const Surroundings surroundings = setup.surroundings();
    const LiftReference reference = setup.reference(surroundings, setup.choice);
    Scenario scenario = setup.scenario;
    struct Row {
        TissueMethod tissue;
        Method method;
        int substeps, iterations;
    };
    std::vector<Row> rows;
    const auto add_rows = [&](TissueMethod tissue, Method method, int iterations,
                              const std::vector<int>& counts) {
        for (const int substeps : counts) {
            rows.push_back({tissue, method, substeps, iterations});
        }
    };
    const std::vector<int> shipped = {8};
    add_rows(TissueMethod::clusters, Method::clusters_for_tongue, 1,
             quick ? shipped : std::vector{8, 16, 24});
    // Substeps of the surroundings.
    add_rows(TissueMethod::implicit, Method::tetrahedra_implicit, pbd::ImplicitMesh::Settings{}.iterations,
             quick ? shipped : std::vector{4, 8, 16});
    for (const Row& row : rows) {
        scenario.physics.tissue_method = row.tissue;
        scenario.physics.substeps = row.substeps;
        const LiftState found = simulate_lift(scenario, setup.patient, setup.way, reference.free());
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

void vary_lift_reference(AccuracyTable& table, bool quick) {
    if (quick) {  // whose steps are too long to be informative
        return;
    }
    Table variants(table.path().parent_path(), "lift-reference.csv",
                   "variant,force_n,force_difference,shape_difference,view_percent,steps,iterations",
                   &table.shard());
    if (!table.shard().claim_next()) {
        return;
    }
    const LiftSetup setup(quick);
    const Surroundings usual = setup.surroundings();
    const LiftReference reference = setup.reference(usual, setup.choice);
    const auto add = [&](std::string_view name, const LiftReference& of) {
        const double apart = (of.lift.force - reference.lift.force).norm() / reference.lift.force.norm();
        variants.row(fmt::format("{},{:.5g},{:.4g},{:.4g},{:.4g},{},{}", name, of.lift.force.norm(), apart,
                                 reference.apart(of.lift), of.lift.opening, of.increments, of.iterations));
    };
    add("as it is", reference);
    LiftSettings slower = setup.choice;
    slower.drag *= 4.0;
    add("four times the drag", setup.reference(usual, slower));
}

void lift_with_other_tremors(AccuracyTable& table, bool quick) {
    if (quick) {  // the first is the lift's own
        return;
    }
    Table tremors(table.path().parent_path(), "lift-tremors.csv",
                  "tremor,force_n,force_expected_n,force_difference,shape_difference,view_percent,view_"
                  "expected_percent",
                  &table.shard());
    for (std::uint64_t tremor = 0; tremor < 4; ++tremor) {
        if (!table.shard().claim_next()) {
            continue;
        }
        const LiftSetup setup(quick, tremor);
        const Surroundings own = setup.surroundings();
        const LiftReference reference = setup.reference(own, setup.choice);
        const LiftState found = simulate_lift(setup.scenario, setup.patient, setup.way, reference.free());
        const double expected = reference.lift.force.norm();
        const double apart = (found.force - reference.lift.force).norm() / expected;
        spdlog::info("lift with tremor {}: told {:.2f} N of {:.2f}, {:.1f} % off", tremor, found.force.norm(),
                     expected, 100.0 * apart);
        tremors.row(fmt::format("{},{:.5g},{:.5g},{:.4g},{:.4g},{:.4g},{:.4g}", tremor, found.force.norm(),
                                expected, apart, reference.apart(found), found.opening,
                                reference.lift.opening));
    }
}

}  // namespace eti::bench
