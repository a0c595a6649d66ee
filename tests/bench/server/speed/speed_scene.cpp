// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <vector>

#include "common/model/pace.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"
#include "server/patient/model/model_file.hpp"
#include "tests/bench/server/speed/speed_meter.hpp"

namespace eti::bench {

namespace {

/// The whole step of the scene and its stages, each the minimum of several steps: a stage disturbed in one
/// step was not in another. The sum of the stages is therefore below the whole.
void stages(SpeedMeter& meter, app::Simulation& simulation, const scene::Inputs& inputs,
            const std::string& when) {
    scene::StepTimer clock;
    simulation.scene().set_step_timer(&clock);
    constexpr auto count = static_cast<std::size_t>(scene::StepStage::count);
    std::array<double, count> least;
    least.fill(1e300);
    const double whole = meter.fastest([&] {
        simulation.scene().step(inputs);
        for (std::size_t i = 0; i < count; ++i) {
            least[i] = std::min(least[i], clock.ms(static_cast<scene::StepStage>(i)));
        }
    });
    simulation.scene().set_step_timer(nullptr);
    meter.add(fmt::format("scenario 'term', {}, per step of 1/180 s", when), 1e-6 * whole, "ms");
    for (std::size_t i = 0; i < count; ++i) {
        meter.add(fmt::format("{}: {}", when, name_of(static_cast<scene::StepStage>(i))), least[i], "ms");
    }
}

/// Wall time [ms]: it includes waiting for background computation.
double clock_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// The slowest and the median step while something sweeps its full range and back. Each step is the minimum
/// of several identical runs, which removes disturbances.
void sweep(SpeedMeter& meter, app::Simulation& simulation, const scene::Inputs& from, const scene::Inputs& to,
           const std::string& what) {
    constexpr int longest = 20 * steps_per_second;
    const int runs = meter.quick() ? 1 : 3;
    std::vector<double> least;
    for (int run = 0; run < runs; ++run) {
        simulation.scene().reset(from);
        for (int i = 0; i < 20; ++i) {
            simulation.scene().step(from);
        }
        std::size_t step = 0;
        for (const scene::Inputs& inputs : {to, from}) {
            // The shell's distance field lags the bones by a second: wait for it, too.
            int still = 0;
            for (int i = 0; i < longest && still < 2 * steps_per_second; ++i, ++step) {
                const RuntimeParameters before = simulation.snapshot().runtime_parameters;
                const double began = clock_ms();
                simulation.scene().step(inputs);
                const double took = clock_ms() - began;
                least.resize(std::max(least.size(), step + 1), 1e300);
                least[step] = std::min(least[step], took);
                still = before == simulation.snapshot().runtime_parameters ? still + 1 : 0;
            }
        }
    }
    std::ranges::sort(least);
    meter.add(fmt::format("{} there and back: middle step", what), least[least.size() / 2], "ms");
    meter.add(fmt::format("{} there and back: slowest step", what), least.back(), "ms");
}

/// A step of a whole scene at rest; the name describes it.
void whole_step(SpeedMeter& meter, const Scenario& scenario, const std::string& name,
                const std::string& state = "tools at rest") {
    const patient::Patient patient = app::patient_of(scenario);
    const scene::Inputs inputs = app::parked_inputs(scenario, patient);
    app::Simulation simulation(scenario, patient, inputs);
    for (int i = 0; i < steps_per_second; ++i) {  // until any liquid has settled
        simulation.scene().step(inputs);
    }
    const double whole = meter.fastest([&] { simulation.scene().step(inputs); });
    meter.add(fmt::format("{}: {} particles of tissue, {}, per step of 1/180 s", name,
                          patient.particles.size(), state),
              1e-6 * whole, "ms");
}

}  // namespace

void measure_whole_scenes(SpeedMeter& meter) {
    const Scenario term = load_scenario(find_data_file("term", "scenarios"));
    whole_step(meter, term, "scenario 'term'", "asleep");
    // Cost of a step once something moves: all of it.
    Scenario premature = load_scenario(find_data_file("premature", "scenarios"));
    premature.physics.sleep = false;
    whole_step(meter, premature, "scenario 'premature'");
    Scenario fine = term;
    fine.physics.sleep = false;
    fine.physics.spacing = 1.5e-3f;
    fine.physics.fine_spacing = 0.75e-3f;
    fine.physics.region = 15e-3f;
    fine.saliva = true;
    whole_step(meter, fine, "scenario 'term' on 1.5 and 0.75 mm within 15 mm, with saliva");
}

void measure_sweeps(SpeedMeter& meter) {
    const Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const patient::Patient patient = app::patient_of(scenario);
    const scene::Inputs start = app::parked_inputs(scenario, patient);
    app::Simulation simulation(scenario, patient, start);
    const auto course = [&](const std::string& what, auto set_low, auto set_high) {
        scene::Inputs low = start, high = start;
        set_low(low);
        set_high(high);
        sweep(meter, simulation, low, high, what);
    };
    course(
        "head 0 to 30 deg", [](auto& i) { i.runtime_parameters.head_elevation = 0.0f; },
        [](auto& i) { i.runtime_parameters.head_elevation = max_head_elevation; });
    course(
        "jaw 0 to 35 deg", [](auto& i) { i.runtime_parameters.jaw_opening = 0.0f; },
        [](auto& i) { i.runtime_parameters.jaw_opening = max_jaw_opening; });
    course(
        "table -20 to 20 deg", [](auto& i) { i.runtime_parameters.table_angle = -max_table_angle; },
        [](auto& i) { i.runtime_parameters.table_angle = max_table_angle; });
    course(
        "tongue scale 0.8 to 1.4", [](auto& i) { i.runtime_parameters.tongue_scale = 0.8f; },
        [](auto& i) { i.runtime_parameters.tongue_scale = 1.4f; });
    course(
        "tissue 1 to 18 kPa", [](auto& i) { i.runtime_parameters.tissue_stiffness = 1e3f; },
        [](auto& i) { i.runtime_parameters.tissue_stiffness = 18e3f; });
    course(
        "head, jaw, table, tongue and tissue together",
        [](auto& i) {
            i.runtime_parameters = {
                .table_angle = -max_table_angle, .tongue_scale = 0.8f, .tissue_stiffness = 1e3f};
        },
        [](auto& i) {
            i.runtime_parameters = {.head_elevation = max_head_elevation,
                                    .jaw_opening = max_jaw_opening,
                                    .table_angle = max_table_angle,
                                    .tongue_scale = 1.4f,
                                    .tissue_stiffness = 18e3f};
        });
}

void measure_scene(SpeedMeter& meter) {
    Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    scenario.physics.sleep = false;  // measures active stages, even while tools are at rest
    const patient::Patient patient = app::patient_of(scenario);
    scene::Inputs inputs = app::parked_inputs(scenario, patient);
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
        hands.apply_to(inputs);
        simulation.step(inputs, std::nullopt);
    }
    stages(meter, simulation, inputs, "blade lifting the tongue");

    scene::SoftTissue tissue(patient, scenario.physics.tissue_method, speed_substep);
    pbd::SoftBody& body = tissue.body();
    meter.add("links of the patient, per substep",
              1e-3 * meter.fastest([&] { body.links.project(body.particles, speed_substep); }), "us");

    metrics::GlotticViewer viewer(patient, simulation.scope());
    const double look = meter.fastest(
        [&] { (void)viewer.evaluate(simulation.snapshot(), best_eye(simulation.snapshot().landmarks)); });
    meter.add("view of the glottis, per look (30 a second)", 1e-6 * look, "ms");

    rigid::RigidLayer layer(simulation.scope(), patient.shell.mesh, patient.shell.triangle_tissue);
    layer.reset(inputs.laryngoscope);
    const double proxy = meter.fastest([&] { (void)layer.step(inputs.laryngoscope, step_duration); });
    meter.add("proxy of the lifting laryngoscope against the shell, per step", 1e-6 * proxy, "ms");
    const double refit = meter.fastest([&] { layer.move_shell(patient.shell.mesh.vertices); });
    meter.add("refit of the shell after a change of posture", 1e-6 * refit, "ms");

    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("eti-bench-{}.h5", ::getpid());
    patient::save_patient(patient, file, {});
    const double load = meter.fastest([&] { (void)patient::load_patient(file); });
    std::filesystem::remove(file);
    meter.add("loading the model file", 1e-6 * load, "ms");
}

}  // namespace eti::bench
