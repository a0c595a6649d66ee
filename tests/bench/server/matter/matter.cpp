// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/matter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/model/pace.hpp"
#include "server/app/run/simulation.hpp"
#include "server/metrics/attempt.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "tests/bench/server/matter/lift_path.hpp"
#include "tests/bench/server/matter/tissue_volume.hpp"

namespace eti::bench {

namespace {

constexpr int still_steps = 270;  // after the path, with the blade still
constexpr int held_steps = 90;    // the last of these, which count
constexpr int rest_steps = 540;   // after the blade has gone

/// What a lift did to the tissue.
struct Lift {
    TissueVolume volume;        // at the end of the path
    double blade_force = 0.0;   // [N], mean while held
    double tongue_force = 0.0;  // [N], the same
    double epiglottis_force = 0.0;
    double greatest_blade = 0.0, greatest_gum = 0.0, greatest_tongue = 0.0, greatest_epiglottis = 0.0;  // [N]
    double view = 0.0;         // [%], mean while held
    double speed = 0.0;        // [m/s], rms of tongue and epiglottis while held
    double penetration = 0.0;  // [m], of a particle's centre into the blade
    double farthest = 0.0;     // [m] from rest, three seconds after the blade has gone
    double step_ms = 0.0;      // mean processor time of a step of the path
};

double processor_ms() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double penetration_of(const Laryngoscope& scope, const RigidTransform& pose, const pbd::Particles& p) {
    double deepest = 0.0;
    for (const Capsule& capsule : scope.capsules) {
        const Vec3f a = pose * capsule.a;
        const Vec3f axis = pose * capsule.b - a;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                const Vec3f from = p.position[i] - a;
                const float along = std::clamp(from.dot(axis) / axis.squaredNorm(), 0.0f, 1.0f);
                deepest =
                    std::max(deepest, static_cast<double>(capsule.radius - (from - along * axis).norm()));
            }
        }
    }
    return deepest;
}

Lift replay(const Scenario& scenario, const patient::Patient& patient, const LiftPath& lift,
            std::ostream* trace) {
    scene::Inputs inputs = app::parked_inputs(scenario, patient);
    const scene::Inputs parked = inputs;
    inputs.laryngoscope = lift.front();
    app::Simulation simulation(scenario, patient, inputs);
    scene::Scene& scene = simulation.scene();
    const pbd::Particles& p = scene.tissue().body().particles;
    std::vector<std::array<std::uint32_t, 4>> tongue;
    for (const std::uint32_t t : patient::tetrahedra_of(Tissue::tongue, patient)) {
        tongue.push_back(patient.tetrahedra.corners[t]);
    }
    std::vector<std::uint32_t> watched;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        const Tissue tissue = scene.tissue().tissue_of(i);
        if (p.inverse_mass[i] > 0.0f && (tissue == Tissue::tongue || tissue == Tissue::epiglottis)) {
            watched.push_back(i);
        }
    }
    Lift out;
    double squared = 0.0;
    std::vector<Vec3f> last;
    LiftPath path = lift;
    path.insert(path.end(), still_steps, path.back());
    for (std::size_t k = 1; k < path.size(); ++k) {
        inputs.laryngoscope = path[k];
        const double before = processor_ms();
        scene.step(inputs);
        out.step_ms += (processor_ms() - before) / static_cast<double>(path.size() - 1);
        simulation.assessor().observe(scene.snapshot(), std::nullopt);
        const metrics::TissueForces forces = metrics::tissue_forces(scene.snapshot());
        const double blade = static_cast<double>(scene.snapshot().tissue_force.norm());
        const double view = static_cast<double>(simulation.metrics().live().measures.glottic_opening_percent);
        out.greatest_blade = std::max(out.greatest_blade, blade);
        out.greatest_gum = std::max(out.greatest_gum, forces.gum);
        out.greatest_tongue = std::max(out.greatest_tongue, forces.tongue);
        out.greatest_epiglottis = std::max(out.greatest_epiglottis, forces.epiglottis);
        const double deep = penetration_of(simulation.scope(), scene.snapshot().last_free, p);
        out.penetration = std::max(out.penetration, deep);
        if (trace != nullptr && k % 18 == 0) {
            const TissueVolume v = volume_of(tongue, p.rest, p.position, 1e-3);
            *trace << fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.3f},{},{:.3f}\n",
                                  static_cast<double>(k) / steps_per_second, blade, forces.tongue,
                                  forces.epiglottis, forces.gum, view, v.share, v.inverted, 1e3 * deep)
                   << std::flush;
        }
        if (k + held_steps >= path.size()) {
            out.blade_force += blade / held_steps;
            out.tongue_force += forces.tongue / held_steps;
            out.epiglottis_force += forces.epiglottis / held_steps;
            out.view += view / held_steps;
            for (std::size_t n = 0; n < watched.size(); ++n) {
                squared += (p.position[watched[n]] - last[watched[n]]).cast<double>().squaredNorm();
            }
        }
        last = p.position;
    }
    out.speed = std::sqrt(squared / held_steps / static_cast<double>(watched.size())) * steps_per_second;
    out.volume = volume_of(tongue, p.rest, p.position);
    // Out along the path, at twice its speed, and away.
    for (std::size_t k = path.size(); k > 2; k -= 2) {
        inputs.laryngoscope = path[k - 1];
        scene.step(inputs);
    }
    inputs.laryngoscope = parked.laryngoscope;
    for (int k = 0; k < rest_steps; ++k) {
        scene.step(inputs);
    }
    for (const std::uint32_t i : watched) {
        out.farthest = std::max(out.farthest, static_cast<double>((p.position[i] - p.rest[i]).norm()));
    }
    return out;
}

std::filesystem::path committed_path(const std::string& scenario) {
    return std::filesystem::path(__FILE__).parent_path() / (scenario + "_lift.csv");
}

}  // namespace

int matter(const MatterOptions& options) {
    if (!options.blocks.empty()) {
        return matter_blocks(options.blocks == "all" ? "" : options.blocks);
    }
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const std::string& name : options.scenarios) {
        Scenario scenario = load_scenario(find_data_file(name, "scenarios"));
        if (options.substeps > 0) {
            scenario.physics.substeps = options.substeps;
        }
        if (options.spacing > 0.0f) {
            scenario.physics.spacing = 1e-3f * options.spacing;
        }
        const patient::Patient patient = app::patient_of(scenario);
        if (!options.record.empty()) {
            write_path(record_lift(scenario, patient), options.record);
            return 0;
        }
        const LiftPath path = read_path(options.path.empty() ? committed_path(name) : options.path);
        std::vector<std::string> methods = options.methods;
        if (methods.empty()) {
            methods.emplace_back(name_of(scenario.physics.tissue_method));
        }
        for (const std::string& method : methods) {
            scenario.physics.tissue_method = static_cast<TissueMethod>(
                std::ranges::find(tissue_method_names, method) - tissue_method_names.begin());
            std::ofstream trace;
            if (!options.trace.empty()) {
                trace.open(options.trace);
                trace << "time_s,blade_n,tongue_n,epiglottis_n,gum_n,view_percent,volume,inverted,"
                         "penetration_mm\n";
            }
            const Lift lift = replay(scenario, patient, path, trace.is_open() ? &trace : nullptr);
            nlohmann::ordered_json row{
                {"scenario", name},
                {"method", method},
                {"tongue_volume_share", lift.volume.share},
                {"tongue_doubly_covered_share", lift.volume.doubly_covered / lift.volume.occupied},
                {"occupied_mm3", 1e9 * lift.volume.occupied},
                {"inverted_cells", lift.volume.inverted},
                {"crushed_cells", lift.volume.crushed},
                {"blade_force_n", lift.blade_force},
                {"tongue_force_n", lift.tongue_force},
                {"epiglottis_force_held_n", lift.epiglottis_force},
                {"blade_force_max_n", lift.greatest_blade},
                {"gum_force_max_n", lift.greatest_gum},
                {"tongue_force_max_n", lift.greatest_tongue},
                {"epiglottis_force_n", lift.greatest_epiglottis},
                {"view_percent", lift.view},
                {"tremble_mm_s", 1e3 * lift.speed},
                {"penetration_mm", 1e3 * lift.penetration},
                {"rest_mm", 1e3 * lift.farthest},
                {"step_ms", lift.step_ms}};
            if (!options.json) {
                for (const auto& [key, value] : row.items()) {
                    std::cout << key << ' '
                              << (value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                                                          : value.dump())
                              << "  ";
                }
                std::cout << std::endl;
            }
            out.push_back(std::move(row));
        }
    }
    if (options.json) {
        std::cout << nlohmann::ordered_json{{"results", out}}.dump(2) << std::endl;
    }
    return 0;
}

}  // namespace eti::bench
