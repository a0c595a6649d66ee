// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/attempt.hpp"

#include <limits>

#include "server/app/local_operator.hpp"
#include "server/app/simulation.hpp"

namespace eti::bench {

namespace {

constexpr double longest = 120.0;  // [s] of simulation time
constexpr float touch = 0.1f;      // [N]
enum : std::size_t { rest, mouth, touched, best, tube, end };

}  // namespace

Attempt perform_and_keep(const Scenario& scenario, const OperatorScript& script) {
    Attempt attempt;
    attempt.scenario = scenario;
    attempt.script = script;
    attempt.patient = app::patient_of(scenario);
    scene::Inputs inputs = app::parked(scenario, attempt.patient);
    app::Simulation simulation(scenario, attempt.patient, inputs);
    attempt.scope = simulation.scope();
    attempt.start = inputs.live;
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, scenario.seed ^ script.seed,
                             simulation.observation());
    hands.hold(inputs);
    simulation.scene().reset(inputs);

    float nearest = -std::numeric_limits<float>::infinity();
    const auto keep = [&](std::size_t which) {
        attempt.moments[which] =
            Moment{simulation.snapshot(), simulation.metrics().live().glottic_opening_percent};
    };
    while (!hands.finished() && simulation.time() < longest) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.hold(inputs);
        simulation.step(inputs, std::nullopt);
        const metrics::Live& live = simulation.metrics().live();
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
        const float seen = live.glottic_opening_percent;
        if (seen > 0.0f && (!attempt.moments[best] || seen > attempt.moments[best]->opening_percent)) {
            keep(best);
        }
        // Until it is through: the first step of those past the glottis stays.
        if (live.attempt_running && nearest < 0.0f && live.tube_depth_past_glottis > nearest) {
            nearest = live.tube_depth_past_glottis;
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
