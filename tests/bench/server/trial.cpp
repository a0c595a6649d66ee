// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/trial.hpp"

#include <chrono>

#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::bench {

namespace {

constexpr double longest_trial = 120.0;  // [s] of simulation time

}  // namespace

TrialResult perform(const Scenario& scenario, const OperatorScript& script, std::uint64_t seed) {
    using Clock = std::chrono::steady_clock;
    const patient::Patient patient = app::patient_of(scenario);
    scene::Inputs inputs = app::parked_inputs(scenario, patient);
    app::Simulation simulation(scenario, patient, inputs);
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, seed, simulation.observation());
    hands.apply_to(inputs);
    simulation.scene().reset(inputs);

    TrialResult trial;
    trial.particles = patient.particles.size();
    Clock::duration spent{};
    while (!hands.finished() && simulation.time() < longest_trial) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.apply_to(inputs);
        const Clock::time_point before = Clock::now();
        simulation.step(inputs, std::nullopt);
        spent += Clock::now() - before;
        trial.blade_force =
            std::max(trial.blade_force, static_cast<double>(simulation.snapshot().tissue_force.norm()));
    }
    simulation.metrics().finish();
    const metrics::AttemptSummary run = simulation.metrics().run();
    const AttemptMetrics& p = run.metrics;
    trial.success = run.outcome.success;
    trial.reason = run.outcome.reason;
    trial.glottic_opening_percent = p.glottic_opening_max_percent;
    trial.view_percent = p.glottic_opening_mean_percent;
    trial.gum_force = p.gum_force_max_n;
    trial.tongue_force = p.tongue_force_max_n;
    trial.epiglottis_force = p.epiglottis_force_max_n;
    trial.time = p.time_s;
    trial.step_ms = std::chrono::duration<double, std::milli>(spent).count() /
                    static_cast<double>(simulation.snapshot().step);
    return trial;
}

}  // namespace eti::bench
