// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/lift_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "common/model/pace.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"
#include "server/patient/model/tetrahedra_of.hpp"

namespace eti::bench {

namespace {

constexpr double longest_lift = 15.0;  // [s] by which the expert has seen the glottis
constexpr double view_settled = 1.5;   // [s] without a better view, after which none is expected
constexpr int held_steps = 270;        // with the blade at rest, until tissue has come to rest
constexpr int averaged_steps = 36;     // the last of them
constexpr int looking = 6;             // steps from one view measurement to the next, of these

/// Particles of the tongue that finite elements may move: mobile ones of its mesh that no active cluster
/// joins to particles outside the mesh.
std::vector<bool> free_of(const scene::Scene& scene, const patient::Patient& patient) {
    const pbd::Particles& p = scene.tissue().body().particles;
    std::vector<bool> meshed(p.size(), false);
    for (const std::uint32_t t : patient::tetrahedra_of(Tissue::tongue, patient)) {
        for (const std::uint32_t i : patient.tetrahedra.corners[t]) {
            meshed[i] = true;
        }
    }
    std::vector<bool> free(p.size(), false);
    for (std::size_t i = 0; i < p.size(); ++i) {
        free[i] = meshed[i] && p.inverse_mass[i] > 0.0f;
    }
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        const auto members = patient.clusters.members(c);
        if (std::ranges::any_of(members,
                                [&](std::uint32_t i) { return !meshed[i] && p.inverse_mass[i] > 0.0f; })) {
            for (const std::uint32_t i : members) {
                free[i] = false;
            }
        }
    }
    return free;
}

/// Other particles of the tongue's mesh and its links.
std::vector<std::uint32_t> held_of(const patient::Patient& patient, const std::vector<bool>& free) {
    std::vector<std::uint32_t> held;
    const auto add = [&](std::uint32_t i) {
        if (!free[i]) {
            held.push_back(i);
        }
    };
    for (const std::uint32_t t : patient::tetrahedra_of(Tissue::tongue, patient)) {
        std::ranges::for_each(patient.tetrahedra.corners[t], add);
    }
    for (const auto& ends : patient.links.ends) {
        if (free[ends[0]] || free[ends[1]]) {
            std::ranges::for_each(ends, add);
        }
    }
    std::ranges::sort(held);
    const auto repeated = std::ranges::unique(held);
    held.erase(repeated.begin(), repeated.end());
    return held;
}

/// Particles of the snapshot's contacts.
std::vector<std::uint32_t> touched_of(const scene::Scene& scene) {
    const std::vector<Vec3f>& position = scene.tissue().body().particles.position;
    std::vector<std::uint32_t> who;
    for (const scene::TissueContact& c : scene.snapshot().tissue_contacts) {
        who.push_back(static_cast<std::uint32_t>(std::ranges::find(position, c.position) - position.begin()));
    }
    return who;
}

void add_mean(std::vector<Vec3d>& mean, const std::vector<Vec3f>& position) {
    mean.resize(position.size(), Vec3d::Zero());
    for (std::size_t i = 0; i < position.size(); ++i) {
        mean[i] += position[i].cast<double>() / averaged_steps;
    }
}

}  // namespace

double opening_of(const patient::Patient& patient, const Laryngoscope& scope,
                  const scene::Snapshot& snapshot) {
    metrics::GlotticViewer::Settings settings;
    settings.samples = 2000;
    return static_cast<double>(metrics::GlotticViewer(patient, scope, settings)
                                   .evaluate(snapshot, best_eye(snapshot.landmarks))
                                   .opening_percent);
}

std::vector<scene::Inputs> lift_of(const Scenario& scenario, const patient::Patient& patient) {
    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    scene::Inputs inputs = app::parked_inputs(scenario, patient);
    app::Simulation simulation(scenario, patient, inputs);
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, scenario.seed ^ script.seed,
                             simulation.observation());
    const RigidTransform tube = inputs.tube_grip;
    hands.apply_to(inputs);
    inputs.tube_grip = tube;
    simulation.scene().reset(inputs);
    std::vector<scene::Inputs> way = {inputs};
    std::size_t best = 0;
    float seen = 0.0f;
    double seen_at = longest_lift;
    while (simulation.time() < std::min(longest_lift, seen_at + view_settled)) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.apply_to(inputs);
        inputs.tube_grip = tube;
        simulation.step(inputs, std::nullopt);
        way.push_back(inputs);
        const float opening = simulation.metrics().live().measures.glottic_opening_percent;
        if (opening > seen) {
            seen = opening;
            seen_at = simulation.time();
            best = way.size();
        }
    }
    if (best == 0) {
        throw std::runtime_error("the expert never saw the glottis: there is no lift to compare");
    }
    way.resize(best);
    way.insert(way.end(), held_steps, way.back());
    return way;
}

Surroundings surroundings_of(const Scenario& scenario, const patient::Patient& patient,
                             const std::vector<scene::Inputs>& way) {
    app::Simulation simulation(scenario, patient, way.front());
    scene::Scene& scene = simulation.scene();
    const pbd::Particles& p = scene.tissue().body().particles;
    Surroundings out;
    out.free = free_of(scene, patient);
    out.held = held_of(patient, out.free);
    out.scope = simulation.scope();
    out.shell = scene.shell();
    out.rest = p.rest;
    for (const auto& edge : scene.tissue().surface_edges()) {
        if (out.free[edge[0]] && out.free[edge[1]]) {
            out.edges.push_back(edge);
        }
    }
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        if (out.free[i] && (p.channels[i] & pbd::channel::shell) != 0) {
            out.meets_shell.push_back(i);
        }
    }
    const auto keep = [&](const std::vector<Vec3f>& position) {
        std::vector<Vec3f>& at = out.held_at.emplace_back();
        for (const std::uint32_t i : out.held) {
            at.push_back(position[i]);
        }
        out.blade.push_back(scene.snapshot().last_free);
    };
    keep(p.position);
    std::vector<Vec3d> mean;
    for (std::size_t k = 1; k < way.size(); ++k) {
        scene.step(way[k]);
        keep(p.position);
        if (k + averaged_steps >= way.size()) {
            add_mean(mean, p.position);
        }
    }
    out.snapshot = scene.snapshot();
    scene::SoftTissue& tissue = out.tissue.emplace_back(scene.tissue());
    for (std::size_t i = 0; i < mean.size(); ++i) {
        tissue.body().particles.position[i] = mean[i].cast<float>();
    }
    keep(tissue.body().particles.position);
    return out;
}

LiftState simulate_lift(const Scenario& scenario, const patient::Patient& patient,
                        const std::vector<scene::Inputs>& way, const std::vector<bool>& counted) {
    using Clock = std::chrono::steady_clock;
    app::Simulation simulation(scenario, patient, way.front());
    scene::Scene& scene = simulation.scene();
    const pbd::Particles& p = scene.tissue().body().particles;
    LiftState out;
    out.touched.resize(p.size(), false);
    Clock::duration spent{};
    double squared =
        0.0;  // [m^2], displacements from step to step: a method's own velocities may be damped ones
    std::vector<Vec3f> last;
    for (std::size_t k = 1; k < way.size(); ++k) {
        last = p.position;
        const Clock::time_point before = Clock::now();
        scene.step(way[k]);
        spent += Clock::now() - before;
        if (k + averaged_steps < way.size()) {
            continue;
        }
        add_mean(out.position, p.position);
        const std::vector<std::uint32_t> who = touched_of(scene);
        for (std::size_t n = 0; n < who.size(); ++n) {
            out.touched[who[n]] = true;
            if (counted[who[n]]) {
                out.force += scene.snapshot().tissue_contacts[n].force.cast<double>() / averaged_steps;
            }
        }
        for (std::size_t i = 0; i < p.size(); ++i) {
            squared += counted[i] ? (p.position[i] - last[i]).cast<double>().squaredNorm() : 0.0;
        }
        if ((way.size() - 1 - k) % looking == 0) {
            out.opening +=
                opening_of(patient, simulation.scope(), scene.snapshot()) * looking / averaged_steps;
        }
    }
    out.speed = std::sqrt(squared / averaged_steps / static_cast<double>(std::ranges::count(counted, true))) *
                steps_per_second;
    out.frame_ms = std::chrono::duration<double, std::milli>(spent).count() /
                   static_cast<double>(way.size() - 1) * steps_per_second / 90.0;
    return out;
}

}  // namespace eti::bench
