// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/attempt.hpp"

#include <limits>

#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::bench {

namespace {

constexpr double longest = 120.0;  // [s] of simulation time
constexpr float touch = 0.1f;      // [N]
enum : std::size_t { rest, mouth, touched, best, tube, end };

}  // namespace

Attempt record_attempt(const Scenario& scenario, const OperatorScript& script) {
    Attempt attempt;
    attempt.scenario = scenario;
    attempt.script = script;
    attempt.patient = app::patient_of(scenario);
    scene::Inputs inputs = app::parked_inputs(scenario, attempt.patient);
    app::Simulation simulation(scenario, attempt.patient, inputs);
    attempt.scope = simulation.scope();
    attempt.start = inputs.runtime_parameters;
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, scenario.seed ^ script.seed,
                             simulation.observation());
    hands.apply_to(inputs);
    simulation.scene().reset(inputs);

    float nearest = -std::numeric_limits<float>::infinity();
    const auto keep = [&](std::size_t which) {
        attempt.moments[which] =
            KeyMoment{simulation.snapshot(), simulation.metrics().live().measures.glottic_opening_percent};
    };
    while (!hands.finished() && simulation.time() < longest) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.apply_to(inputs);
        simulation.step(inputs, std::nullopt);
        const metrics::LiveMetrics& live = simulation.metrics().live();
        const scene::Snapshot& now = simulation.snapshot();
        if (!attempt.moments[rest]) {
            keep(rest);
        }
        if (!attempt.moments[mouth] && live.attempt_running) {
            keep(mouth);
        }
        if (!attempt.moments[touched] && now.tissue_force.norm() > touch) {
            keep(touched);
        }
        const float seen = live.measures.glottic_opening_percent;
        if (seen > 0.0f && (!attempt.moments[best] || seen > attempt.moments[best]->opening_percent)) {
            keep(best);
        }
        // Until it is through: the first step of those past the glottis stays.
        if (live.attempt_running && nearest < 0.0f && live.measures.tube_depth_past_glottis > nearest) {
            nearest = live.measures.tube_depth_past_glottis;
            keep(tube);
        }
    }
    keep(end);
    simulation.metrics().finish();
    const metrics::AttemptSummary run = simulation.metrics().run();
    attempt.success = run.outcome.success;
    attempt.reason = run.outcome.reason;
    return attempt;
}

}  // namespace eti::bench
