// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/matter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/math/units.hpp"
#include "common/model/pace.hpp"
#include "server/app/run/patient_cache.hpp"
#include "server/app/run/simulation.hpp"
#include "server/metrics/attempt.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "server/patient/newborn/from_scenario.hpp"
#include "tests/bench/server/matter/block_cases.hpp"
#include "tests/bench/server/matter/lift_path.hpp"
#include "tests/bench/server/matter/tissue_volume.hpp"
#include "tests/bench/server/source_file.hpp"
#include "tests/bench/server/table.hpp"

namespace eti::bench {

namespace {

constexpr int still_steps = 270;  // after the path, with the blade still
constexpr int held_steps = 90;    // the last of these, which count
constexpr int hold_steps = 720;   // in which a held blade's force is said to fall
constexpr int hold_mean = 18;     // of a force at either end of these
constexpr int rest_steps = 540;   // after the blade has gone
constexpr int lever_steps = 180;  // in which a held blade is pitched by lever_angle
constexpr float lever_angle = 45.0f * degree;

/// What a lift did to the tissue.
struct Lift {
    TissueVolume volume;        // at the end of the path
    double blade_force = 0.0;   // [N], mean while held
    double tongue_force = 0.0;  // [N], the same
    double epiglottis_force = 0.0;
    double greatest_blade = 0.0, greatest_gum = 0.0, greatest_tongue = 0.0, greatest_epiglottis = 0.0;  // [N]
    double lever_gum = 0.0;    // [N], greatest while the held blade is pitched about the upper gum
    double relaxation = 0.0;   // blade's force after hold_steps over that when it came to be held
    double view = 0.0;         // [%], mean while held
    double speed = 0.0;        // [m/s], rms of tongue and epiglottis while held
    double penetration = 0.0;  // [m], of a particle's centre into the blade
    double farthest = 0.0;     // [m] from rest, three seconds after the blade has gone
    double step_ms = 0.0;      // mean processor time of a step of the path
    scene::YieldingSkeleton::Vector bones = scene::YieldingSkeleton::Vector::Zero();  // offsets while held
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

/// The first step from which on the blade stays where it is at the end.
std::size_t held_from(const LiftPath& path) {
    constexpr float still = 0.1e-3f;  // [m], a hand's tremor
    std::size_t k = path.size() - 1;
    while (k > 0 && (path[k - 1].translation - path.back().translation).norm() <= still) {
        --k;
    }
    return k;
}

/// Until the held blade's force has fallen for hold_steps or, if `whole`, until levering and rest are over.
Lift replay(const Scenario& scenario, const patient::Patient& patient, const LiftPath& lift,
            std::ostream* trace, bool whole = true) {
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
    const std::vector<Vec3f> rest = p.rest;
    Lift out;
    double squared = 0.0;
    std::vector<Vec3f> last;
    LiftPath path = lift;
    const std::size_t held = held_from(path);
    path.insert(path.end(), still_steps, path.back());
    const std::size_t judged = path.size();
    const std::size_t hold_end = held + hold_steps + hold_mean / 2;
    path.resize(std::max(judged, hold_end), path.back());
    double first_force = 0.0;  // sums over hold_mean steps
    double last_force = 0.0;
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
            const auto bones = scene.skeleton() == nullptr ? scene::YieldingSkeleton::Vector::Zero().eval()
                                                           : scene.skeleton()->offset();
            const TissueVolume v = volume_of(tongue, rest, p.position, 1e-3);
            *trace << fmt::format(
                          "{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.3f},{},{:.3f},"
                          "{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}\n",
                          static_cast<double>(k) / steps_per_second, blade, forces.tongue, forces.epiglottis,
                          forces.gum, view, v.share, v.inverted, 1e3 * deep, bones[0] / degree,
                          1e3f * bones[1], bones[2] / degree, 1e3f * bones[3],
                          1e3f * bones.segment<3>(4).norm())
                   << std::flush;
        }
        first_force += k >= held && k < held + hold_mean ? blade : 0.0;
        last_force += k + hold_mean >= hold_end && k < hold_end ? blade : 0.0;
        if (k + held_steps >= judged && k < judged) {
            out.blade_force += blade / held_steps;
            out.tongue_force += forces.tongue / held_steps;
            out.epiglottis_force += forces.epiglottis / held_steps;
            out.view += view / held_steps;
            for (std::size_t n = 0; n < watched.size(); ++n) {
                squared += (p.position[watched[n]] - last[watched[n]]).cast<double>().squaredNorm();
            }
        }
        last = p.position;
        if (k + 1 == judged) {
            out.volume = volume_of(tongue, rest, p.position);
            if (scene.skeleton() != nullptr) {
                out.bones = scene.skeleton()->offset();
            }
        }
    }
    out.relaxation = last_force / first_force;
    if (!whole) {
        return out;
    }
    out.speed = std::sqrt(squared / held_steps / static_cast<double>(watched.size())) * steps_per_second;
    // As a novice who levers: the tip up, with the upper gum as the fulcrum.
    const Vec3f fulcrum = at(scene.snapshot().landmarks, Landmark::upper_gum);
    const RigidTransform lifted = path.back();
    for (int k = 1; k <= lever_steps; ++k) {
        const float angle = -lever_angle * static_cast<float>(k) / lever_steps;
        inputs.laryngoscope =
            RigidTransform::about(fulcrum, lifted.rotation * Vec3f::UnitX(), angle) * lifted;
        scene.step(inputs);
        out.lever_gum = std::max(out.lever_gum, metrics::tissue_forces(scene.snapshot()).gum);
    }
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
    return source_file("tests/bench/server/matter/" + scenario + "_lift.csv");
}

patient::Patient patient_of(const MatterOptions& options, const Scenario& scenario) {
    if (!options.plate) {
        return app::patient_of(scenario);
    }
    patient::BuildSettings settings = patient::settings_of(scenario);
    settings.plate = true;
    return app::cached_patient(scenario.patient.shape, settings);
}

Scenario scenario_of(const MatterOptions& options, const std::string& name) {
    Scenario scenario = load_scenario(find_data_file(name, "scenarios"));
    if (options.substeps > 0) {
        scenario.physics.substeps = options.substeps;
    }
    if (options.fine_spacing > 0.0) {
        scenario.physics.fine_spacing = static_cast<float>(1e-3 * options.fine_spacing);
    }
    if (options.spacing > 0.0) {
        scenario.physics.spacing = static_cast<float>(1e-3 * options.spacing);
    }
    scenario.physics.bones_yield = scenario.physics.bones_yield && !options.fixed_bones;
    scenario.physics.relaxation = scenario.physics.relaxation && !options.elastic;
    return scenario;
}

nlohmann::ordered_json row_of(const std::string& scenario, const std::string& variant,
                              const std::string& method, const Lift& lift) {
    return {{"scenario", scenario},
            {"variant", variant},
            {"method", method},
            {"tongue_volume_share", lift.volume.share},
            {"tongue_doubly_covered_share", lift.volume.doubly_covered / lift.volume.occupied},
            {"tongue_occupied_mm3", 1e9 * lift.volume.occupied},
            {"inverted_cells", lift.volume.inverted},
            {"crushed_cells", lift.volume.crushed},
            {"blade_force_held_n", lift.blade_force},
            {"tongue_force_held_n", lift.tongue_force},
            {"epiglottis_force_held_n", lift.epiglottis_force},
            {"blade_force_n", lift.greatest_blade},
            {"gum_force_expert_n", lift.greatest_gum},
            {"gum_force_lever_n", lift.lever_gum},
            {"tongue_force_n", lift.greatest_tongue},
            {"epiglottis_force_n", lift.greatest_epiglottis},
            {"hold_relaxation_share", lift.relaxation},
            {"view_percent", lift.view},
            {"tremble_mm_per_s", 1e3 * lift.speed},
            {"penetration_mm", 1e3 * lift.penetration},
            {"from_rest_mm", 1e3 * lift.farthest},
            {"head_extension_deg", lift.bones[scene::YieldingSkeleton::head_extension] / degree},
            {"head_lift_mm", 1e3f * lift.bones[scene::YieldingSkeleton::head_lift]},
            {"jaw_opening_deg", lift.bones[scene::YieldingSkeleton::jaw_opening] / degree},
            {"jaw_slide_mm", 1e3f * lift.bones[scene::YieldingSkeleton::jaw_slide]},
            {"hyoid_shift_mm", 1e3f * lift.bones.segment<3>(scene::YieldingSkeleton::hyoid_left).norm()},
            {"step_ms", lift.step_ms}};
}

/// Greatest absolute value of `key` over blades at least 2 mm deep in cells of the shipped spacing.
double greatest_error(const nlohmann::ordered_json& blocks, const std::string& key) {
    double most = 0.0;
    for (const auto& row : blocks) {
        if (row.at("case") == "blade" && row.at("element") == "hexahedra" && row.at("depth_mm") > 1.9 &&
            std::fabs(row.at("cell_mm").get<double>() - 2.0) < 1e-6) {
            most = std::max(most, std::fabs(row.at(key).get<double>()));
        }
    }
    return most;
}

std::string text_of(const nlohmann::ordered_json& value) {
    if (value.is_string()) {
        return value.get<std::string>();
    }
    if (!value.is_number_float()) {
        return value.dump();
    }
    return std::isfinite(value.get<double>()) ? fmt::format("{:.4g}", value.get<double>()) : "";
}

void print(const nlohmann::ordered_json& rows) {
    for (const auto& row : rows) {
        std::string line;
        for (const auto& [key, value] : row.items()) {
            line += fmt::format("{} {}  ", key, text_of(value));
        }
        std::cout << line << std::endl;
    }
}

/// Replays the lift of each scenario in each method of tissue, and prints rows as they are done.
nlohmann::ordered_json replayed_lifts(const MatterOptions& options, const char* variant) {
    nlohmann::ordered_json lifts = nlohmann::ordered_json::array();
    for (const std::string& name : options.scenarios) {
        Scenario scenario = scenario_of(options, name);
        const patient::Patient patient = patient_of(options, scenario);
        const LiftPath path = read_path(options.path.empty() ? committed_path(name) : options.path);
        std::vector<std::string> methods = options.methods;
        if (methods.empty()) {
            methods.emplace_back(name_of(scenario.physics.tissue_method));
        }
        for (const std::string& method : methods) {
            const auto* const found = std::ranges::find(tissue_method_names, method);
            if (found == tissue_method_names.end()) {
                throw std::runtime_error("--method: '" + method + "' is none of " +
                                         fmt::format("{}", fmt::join(tissue_method_names, ", ")));
            }
            scenario.physics.tissue_method = static_cast<TissueMethod>(found - tissue_method_names.begin());
            std::ofstream trace;
            if (!options.trace.empty()) {
                trace.open(options.trace);
                trace << "time_s,blade_n,tongue_n,epiglottis_n,gum_n,view_percent,volume,inverted,"
                         "penetration_mm,extension_deg,lift_mm,opening_deg,slide_mm,hyoid_mm\n";
            }
            Lift lift = replay(scenario, patient, path, trace.is_open() ? &trace : nullptr);
            if (options.no_hold) {
                lift.relaxation = std::numeric_limits<double>::quiet_NaN();
            } else if (options.path.empty()) {
                // An expert who lifts until he sees lifts so slowly that most stress has relaxed before.
                const LiftPath quick = read_path(committed_path(name + "_quick"));
                lift.relaxation = replay(scenario, patient, quick, nullptr, false).relaxation;
            }
            lifts.push_back(row_of(name, variant, method, lift));
            if (!options.json) {
                print(nlohmann::ordered_json::array({lifts.back()}));
            }
        }
        if (options.quick) {
            break;
        }
    }
    return lifts;
}

constexpr const char* shipped = "shipped";

/// Other settings of the same lift.
struct Variant {
    const char* name;
    void (*set)(MatterOptions&);
};
constexpr std::array variants = {
    Variant{"fixed bones", [](MatterOptions& m) { m.fixed_bones = true; }},
    Variant{"elastic", [](MatterOptions& m) { m.elastic = true; }},
    // Of other resolutions nothing is said of a quick lift.
    Variant{"4 substeps", [](MatterOptions& m) { m.substeps = 4, m.no_hold = true; }},
    Variant{"16 substeps", [](MatterOptions& m) { m.substeps = 16, m.no_hold = true; }},
    Variant{"2.5 mm", [](MatterOptions& m) { m.spacing = 2.5, m.no_hold = true; }},
    Variant{"1.5 mm", [](MatterOptions& m) { m.spacing = 1.5, m.no_hold = true; }},
};

/// Writes rows as a table. Values that a row lacks stay empty.
void write(const nlohmann::ordered_json& rows, const std::filesystem::path& folder, const std::string& name) {
    std::vector<std::string> keys;
    for (const auto& row : rows) {
        for (const auto& [key, value] : row.items()) {
            if (std::ranges::find(keys, key) == keys.end()) {
                keys.push_back(key);
            }
        }
    }
    Table table(folder, name, fmt::format("{}", fmt::join(keys, ",")));
    for (const auto& row : rows) {
        std::vector<std::string> cells;
        for (const std::string& key : keys) {
            cells.push_back(row.contains(key) ? text_of(row.at(key)) : "");
        }
        table.row(fmt::format("{}", fmt::join(cells, ",")));
    }
}

}  // namespace

int matter(const MatterOptions& options) {
    if (!options.record.empty()) {
        const Scenario scenario = scenario_of(options, options.scenarios.front());
        write_path(record_lift(scenario, patient_of(options, scenario)), options.record);
        return 0;
    }
    nlohmann::ordered_json lifts = replayed_lifts(options, shipped);
    if (!options.out.empty()) {
        for (const Variant& variant : variants) {
            MatterOptions other = options;
            variant.set(other);
            const auto more = replayed_lifts(other, variant.name);
            lifts.insert(lifts.end(), more.begin(), more.end());
        }
    }
    const nlohmann::ordered_json blocks =
        options.no_blocks ? nlohmann::ordered_json::array() : reference_blocks(options.quick);
    if (!options.out.empty()) {
        write(lifts, options.out, "matter.csv");
        write(blocks, options.out, "matter-blocks.csv");
    }
    if (!options.json) {
        print(blocks);
        return 0;
    }
    nlohmann::ordered_json results = lifts.front();
    results["reference_force_error"] = greatest_error(blocks, "error");
    results["reference_shape_error"] = greatest_error(blocks, "shape_error");
    std::cout << nlohmann::ordered_json{{"results", results}, {"lifts", lifts}, {"blocks", blocks}}.dump(2)
              << std::endl;
    return 0;
}

}  // namespace eti::bench
