// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <unistd.h>

#include <array>
#include <filesystem>

#include "server/anatomy/model_file.hpp"
#include "server/app/local_operator.hpp"
#include "server/app/simulation.hpp"
#include "tests/bench/server/speed_meter.hpp"

namespace eti::bench {

namespace {

/// The whole step of the scene and its stages, each the least of several steps: a stage that was disturbed in
/// one step was not in another. The stages' sum is therefore below the whole.
void stages(SpeedMeter& meter, app::Simulation& simulation, const scene::Inputs& inputs,
            const std::string& when) {
    scene::StageClock clock;
    simulation.scene().time_stages(&clock);
    constexpr auto count = static_cast<std::size_t>(scene::Stage::count);
    std::array<double, count> least;
    least.fill(1e300);
    const double whole = meter.fastest([&] {
        simulation.scene().step(inputs);
        for (std::size_t i = 0; i < count; ++i) {
            least[i] = std::min(least[i], clock.ms(static_cast<scene::Stage>(i)));
        }
    });
    simulation.scene().time_stages(nullptr);
    meter.add(fmt::format("scenario 'term', {}, per step of 1/180 s", when), 1e-6 * whole, "ms");
    for (std::size_t i = 0; i < count; ++i) {
        meter.add(fmt::format("{}: {}", when, name_of(static_cast<scene::Stage>(i))), least[i], "ms");
    }
}

/// A step of a whole scene at rest, of which the name says what it is.
void whole_step(SpeedMeter& meter, const Scenario& scenario, const std::string& name) {
    const anatomy::Patient patient = app::patient_of(scenario);
    const scene::Inputs inputs = app::parked(scenario);
    app::Simulation simulation(scenario, patient, inputs);
    for (int i = 0; i < scene::steps_per_second; ++i) {  // until what liquid there is has settled
        simulation.scene().step(inputs);
    }
    const double whole = meter.fastest([&] { simulation.scene().step(inputs); });
    meter.add(fmt::format("{}: {} particles of tissue, tools at rest, per step of 1/180 s", name,
                          patient.particles.size()),
              1e-6 * whole, "ms");
}

}  // namespace

void measure_whole_scenes(SpeedMeter& meter) {
    whole_step(meter, load_scenario(find_data_file("premature", "scenarios")), "scenario 'premature'");
    Scenario fine = load_scenario(find_data_file("term", "scenarios"));
    fine.physics.spacing = 1.5e-3f;
    fine.physics.fine_spacing = 0.75e-3f;
    fine.physics.region = 15e-3f;
    fine.saliva = true;
    whole_step(meter, fine, "scenario 'term' on 1.5 and 0.75 mm within 15 mm, with saliva");
}

void measure_scene(SpeedMeter& meter) {
    const Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const anatomy::Patient patient = app::patient_of(scenario);
    scene::Inputs inputs = app::parked(scenario);
    app::Simulation simulation(scenario, patient, inputs);
    for (int i = 0; i < 20; ++i) {
        simulation.step(inputs, std::nullopt);
    }
    stages(meter, simulation, inputs, "tools at rest");

    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, script.seed,
                             simulation.observation());
    while (simulation.observation().glottic_opening_percent < 30.0f && simulation.time() < 20.0) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.hold(inputs);
        simulation.step(inputs, std::nullopt);
    }
    stages(meter, simulation, inputs, "blade lifting the tongue");

    scene::SoftTissue tissue(patient, scenario.physics.tissue_model, speed_substep);
    pbd::SoftBody& body = tissue.body();
    meter.add("links of the patient, per substep",
              1e-3 * meter.fastest([&] { body.links.project(body.particles, speed_substep); }), "us");

    metrics::GlotticViewer viewer(patient, simulation.scope());
    const double look = meter.fastest(
        [&] { (void)viewer.look(simulation.snapshot(), best_eye(simulation.snapshot().landmarks)); });
    meter.add("view of the glottis, per look (30 a second)", 1e-6 * look, "ms");

    rigid::RigidLayer layer(simulation.scope(), patient.shell.mesh, patient.shell.triangle_tissue);
    layer.reset(inputs.laryngoscope);
    const double proxy = meter.fastest([&] { (void)layer.step(inputs.laryngoscope, scene::step_duration); });
    meter.add("proxy of the lifting laryngoscope against the shell, per step", 1e-6 * proxy, "ms");
    const double refit = meter.fastest([&] { layer.move_shell(patient.shell.mesh.vertices); });
    meter.add("refit of the shell after a change of posture", 1e-6 * refit, "ms");

    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("eti-bench-{}.h5", ::getpid());
    anatomy::save_patient(patient, file, {});
    const double load = meter.fastest([&] { (void)anatomy::load_patient(file); });
    std::filesystem::remove(file);
    meter.add("loading the model file", 1e-6 * load, "ms");
}

}  // namespace eti::bench
