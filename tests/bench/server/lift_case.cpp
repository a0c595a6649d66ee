// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "server/anatomy/made_of.hpp"
#include "server/app/local_operator.hpp"
#include "server/app/simulation.hpp"
#include "tests/bench/server/accuracy_table.hpp"
#include "tests/bench/server/block_cases.hpp"

namespace eti::bench {

namespace {

constexpr double longest = 15.0;     // [s] by which the expert has seen the glottis
constexpr int held_steps = 270;      // at standstill, until tissue has come to rest
constexpr int averaged_steps = 36;   // the last of them, over which forces are averaged
constexpr float touching = 0.1e-3f;  // [m] between tissue and shell
constexpr double settled = 1.5;      // [s] without a better view, after which there is none to come

/// The scene as the laryngoscope stands still at the best view.
struct Lift {
    scene::Snapshot snapshot;
    std::vector<Vec3f> position;  ///< [m], of all particles
    Vec3d force = Vec3d::Zero();  ///< [N], of the tongue on the blade
    double opening = 0.0;         ///< POGO [%]
    double frame_ms = 0.0;        ///< wall time per simulated 1/90 s
};

/// The expert's laryngoscope from the start until the glottis is seen best, tube parked.
std::vector<scene::Inputs> lift_of(const Scenario& scenario, const anatomy::Patient& patient) {
    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    scene::Inputs inputs = app::parked(scenario);
    app::Simulation simulation(scenario, patient, inputs);
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, scenario.seed ^ script.seed,
                             simulation.observation());
    const RigidTransform tube = inputs.tube_grip;
    hands.hold(inputs);
    inputs.tube_grip = tube;
    simulation.scene().reset(inputs);
    std::vector<scene::Inputs> way = {inputs};
    std::size_t best = 0;
    float seen = 0.0f;
    double seen_at = longest;
    while (simulation.time() < std::min(longest, seen_at + settled)) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.hold(inputs);
        inputs.tube_grip = tube;
        simulation.step(inputs, std::nullopt);
        way.push_back(inputs);
        const float opening = simulation.metrics().live().glottic_opening_percent;
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
    return way;
}

double opening_of(const anatomy::Patient& patient, const Laryngoscope& scope,
                  const scene::Snapshot& snapshot) {
    metrics::GlotticViewer::Settings settings;
    settings.samples = 2000;
    return static_cast<double>(metrics::GlotticViewer(patient, scope, settings)
                                   .look(snapshot, best_eye(snapshot.landmarks))
                                   .opening_percent);
}

/// The particles that the snapshot's contacts are of.
std::vector<std::uint32_t> touched_of(const scene::Scene& scene) {
    const std::vector<Vec3f>& position = scene.tissue().body().particles.position;
    std::vector<std::uint32_t> who;
    for (const scene::TissueContact& c : scene.snapshot().tissue_contacts) {
        who.push_back(static_cast<std::uint32_t>(std::ranges::find(position, c.position) - position.begin()));
    }
    return who;
}

/// Which particles of the tongue finite elements may move: no cluster joins them to other tissue, no link
/// holds them, and they do not lie on the shell.
std::vector<bool> free_of(const scene::Scene& scene, const anatomy::Patient& patient) {
    const pbd::Particles& p = scene.tissue().body().particles;
    const auto of_tongue = [&](std::uint32_t i) { return scene.tissue().tissue_of(i) == Tissue::tongue; };
    std::vector<bool> free(p.size(), false);
    for (const auto& corners : patient.tetrahedra.corners) {
        if (anatomy::made_of(Tissue::tongue, corners, patient.particles)) {
            for (const std::uint32_t i : corners) {
                free[i] = p.inverse_mass[i] > 0.0f && scene.shell().distance(p.position[i]) > touching;
            }
        }
    }
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        const auto members = patient.clusters.members(c);
        if (!std::ranges::all_of(members, of_tongue)) {
            for (const std::uint32_t i : members) {
                free[i] = false;
            }
        }
    }
    for (const auto& ends : patient.links.ends) {
        free[ends[0]] = free[ends[1]] = false;
    }
    return free;
}

/// The tongue's equilibrium under the blade by finite elements on its own mesh; all else stays where the
/// finest run has it, which also tells where blade and shell hold it by friction.
class Reference {
  public:
    Reference(const Scenario& scenario, const anatomy::Patient& patient,
              const std::vector<scene::Inputs>& way, int substeps) {
        Scenario finest = scenario;
        finest.physics.substeps = substeps;
        app::Simulation simulation(finest, patient, way.front());
        for (std::size_t k = 1; k < way.size() + held_steps; ++k) {
            simulation.scene().step(way[std::min(k, way.size() - 1)]);
        }
        const scene::Scene& scene = simulation.scene();
        const pbd::Particles& p = scene.tissue().body().particles;
        free_ = free_of(scene, patient);
        fem::Problem problem;
        std::vector<std::uint32_t> number(p.size(), ~0u);
        std::vector<Vec3d> start;
        for (const auto& corners : patient.tetrahedra.corners) {
            if (!anatomy::made_of(Tissue::tongue, corners, patient.particles)) {
                continue;
            }
            std::array<std::uint32_t, 4> ends{};
            for (std::size_t v = 0; v < 4; ++v) {
                const std::uint32_t i = corners[v];
                if (number[i] == ~0u) {
                    number[i] = static_cast<std::uint32_t>(problem.rest.size());
                    problem.rest.push_back(p.rest[i].cast<double>());
                    start.push_back(p.position[i].cast<double>());
                    if (!free_[i]) {
                        problem.hold(number[i], start.back() - problem.rest.back());
                    }
                }
                ends[v] = number[i];
            }
            problem.tetrahedra.push_back(ends);
        }
        problem.youngs_modulus = static_cast<double>(scenario.patient.tissue_stiffness);
        problem.poisson_ratio = poisson_ratio;
        // Where the blade holds tissue by friction too, only its reaction can be compared.
        std::vector<std::uint32_t> touched;
        for (const std::uint32_t i : touched_of(scene)) {
            if (free_[i]) {
                touched.push_back(i);
                problem.hold(number[i], start[number[i]] - problem.rest[number[i]]);
            }
        }
        const fem::Solution solution = fem::solve(problem, start);
        if (!solution.converged) {
            throw std::runtime_error("the reference of the lifted tongue did not converge");
        }
        lift.snapshot = scene.snapshot();
        lift.position = p.position;
        Eigen::VectorXd x(3 * static_cast<Eigen::Index>(start.size()));
        for (std::size_t n = 0; n < start.size(); ++n) {
            x.segment<3>(3 * static_cast<Eigen::Index>(n)) = solution.position[n];
        }
        const Eigen::VectorXd slope = fem::Potential(problem).gradient(x);
        for (const std::uint32_t i : touched) {
            lift.force -= slope.segment<3>(3 * static_cast<Eigen::Index>(number[i]));
        }
        scene::SoftTissue tissue = scene.tissue();
        for (std::size_t i = 0; i < number.size(); ++i) {
            if (free_[i]) {
                lift.position[i] = solution.position[number[i]].cast<float>();
                tissue.body().particles.position[i] = lift.position[i];
            }
        }
        tissue.frames(lift.snapshot.frames);
        lift.opening = opening_of(patient, simulation.scope(), lift.snapshot);
        rest_ = p.rest;
    }

    /// Root mean square over the particles that finite elements moved, in parts of their displacement.
    [[nodiscard]] double apart(const Lift& other) const {
        double apart = 0.0;
        double moved = 0.0;
        for (std::size_t i = 0; i < free_.size(); ++i) {
            if (free_[i]) {
                apart += static_cast<double>((other.position[i] - lift.position[i]).squaredNorm());
                moved += static_cast<double>((lift.position[i] - rest_[i]).squaredNorm());
            }
        }
        return std::sqrt(apart / moved);
    }

    Lift lift;
    /// By particle, whether finite elements may move it, or the blade holds it.
    [[nodiscard]] const std::vector<bool>& free() const { return free_; }

  private:
    std::vector<bool> free_;
    std::vector<Vec3f> rest_;
};

Lift by_particles(const Scenario& scenario, const anatomy::Patient& patient,
                  const std::vector<scene::Inputs>& way, const std::vector<bool>& counted) {
    using Clock = std::chrono::steady_clock;
    app::Simulation simulation(scenario, patient, way.front());
    scene::Scene& scene = simulation.scene();
    Lift out;
    Clock::duration spent{};
    for (std::size_t k = 1; k < way.size() + held_steps; ++k) {
        const Clock::time_point before = Clock::now();
        scene.step(way[std::min(k, way.size() - 1)]);
        spent += Clock::now() - before;
        if (k >= way.size() + held_steps - averaged_steps) {
            const std::vector<std::uint32_t> who = touched_of(scene);
            for (std::size_t n = 0; n < who.size(); ++n) {
                if (counted[who[n]]) {
                    out.force += scene.snapshot().tissue_contacts[n].force.cast<double>() / averaged_steps;
                }
            }
        }
    }
    out.frame_ms = std::chrono::duration<double, std::milli>(spent).count() /
                   static_cast<double>(way.size() + held_steps) * scene::steps_per_second / 90.0;
    out.snapshot = scene.snapshot();
    out.position = scene.tissue().body().particles.position;
    out.opening = opening_of(patient, simulation.scope(), out.snapshot);
    return out;
}

}  // namespace

void lift_tongue(AccuracyTable& table, bool quick) {
    Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const anatomy::Patient patient = app::patient_of(scenario);
    const std::vector<scene::Inputs> way = lift_of(scenario, patient);
    const Reference reference(scenario, patient, way, quick ? 12 : 32);
    spdlog::info("lift: finite elements {:.2f} N, view {:.1f} %", reference.lift.force.norm(),
                 reference.lift.opening);
    for (const auto& [model, method] : {std::pair{TissueModel::clusters, Method::clusters_for_tongue},
                                        std::pair{TissueModel::tetrahedra, Method::tetrahedra}}) {
        for (const int substeps : quick ? std::vector{8} : std::vector{6, 8, 12, 16, 24}) {
            scenario.physics.tissue_model = model;
            scenario.physics.substeps = substeps;
            const Lift found = by_particles(scenario, patient, way, reference.free());
            spdlog::info("lift: {}, {} substeps {:.2f} N, view {:.1f} %", name_of(method), substeps,
                         found.force.norm(), found.opening);
            const auto add = [&](std::string_view name, double error) {
                table.add({name, name_of(method), static_cast<double>(scenario.physics.spacing), substeps, 1,
                           found.position.size(), error, found.frame_ms});
            };
            add("lift-force", (found.force - reference.lift.force).norm() / reference.lift.force.norm());
            add("lift-shape", reference.apart(found));
            add("lift-view", std::fabs(found.opening - reference.lift.opening) / 100.0);
        }
    }
}

}  // namespace eti::bench
