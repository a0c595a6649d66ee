// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/quality.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "common/model/pace.hpp"
#include "common/scenario/setting.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::app {

namespace {

constexpr int most_steps = 40;  // that are timed
// A step in the lift costs 1.4 times as much as one with the tools at rest (docs/solver/cost.md), and the
// simulation sleeps for 15 % of its steps' cost.
constexpr double lift_cost = 1.4 * 1.15;

/// Cost [s] of a step with all tissue awake and the tools at rest: the first that keeps real time, or the
/// smallest.
double awake_step_cost(const Scenario& scenario, const patient::Patient& patient) {
    Scenario awake = scenario;
    awake.physics.sleep = false;
    const scene::Inputs inputs = parked_inputs(awake, patient);
    Simulation simulation(awake, patient, inputs);
    using Clock = std::chrono::steady_clock;
    double least = std::numeric_limits<double>::infinity();
    for (int step = 0; step < most_steps && !keeps_real_time(least); ++step) {
        const Clock::time_point began = Clock::now();
        simulation.scene().step(inputs);
        least = std::min(least, std::chrono::duration<double>(Clock::now() - began).count());
    }
    return least;
}

}  // namespace

Scenario reduced(const Scenario& scenario) {
    const int substeps = std::max(1, scenario.physics.substeps / 2);
    return parse_scenario(with_setting(scenario.text, fmt::format("physics.substeps={}", substeps)),
                          scenario.folder / scenario.name);
}

bool keeps_real_time(double awake_step_cost) {
    return lift_cost * awake_step_cost < step_duration;
}

Quality finest_in_real_time(const Scenario& scenario, const patient::Patient& patient) {
    const double cost = awake_step_cost(scenario, patient);
    const Quality quality = keeps_real_time(cost) ? Quality::full : Quality::reduced;
    spdlog::info("quality '{}': with all tissue awake, a step takes {:.1f} ms of {:.1f}", name_of(quality),
                 1e3 * cost, 1e3 * step_duration);
    return quality;
}

}  // namespace eti::app
