// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <cstdlib>

#include "common/math/units.hpp"
#include "common/process/command_line.hpp"
#include "common/process/stop_signal.hpp"
#include "server/patient/model/model_file.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/patient/newborn/build/check_model.hpp"
#include "server/patient/newborn/dimensions.hpp"
#include "server/patient/tool/commands.hpp"

namespace eti::tool {

namespace {

/// Gestational age of a model, or the default if it does not state one.
float age_of(const patient::Provenance& provenance, float weight) {
    const auto said = provenance.find("gestational_age_weeks");
    const float age = said == provenance.end() ? 0.0f : std::strtof(said->second.c_str(), nullptr);
    return age > 0.0f ? age : median_gestational_age(weight);
}

double degrees(float angle) {
    return static_cast<double>(angle / degree);
}

Result check_file(const std::filesystem::path& file, float jaw_opening_deg) {
    (void)progress(0.0f, "reading " + file.string());
    const patient::Patient patient = patient::load_patient(file);
    const patient::Provenance provenance = patient::load_provenance(file);
    Result result;
    result.json["model"] = file.string();
    result.json["provenance"] = provenance;

    (void)progress(0.1f, "checking");
    std::size_t faults = 0;
    for (const patient::Invariant& i : patient::check_model(patient)) {
        faults += i.holds ? 0 : 1;
        result.text += fmt::format("{:<5} {:<62} {}\n", i.holds ? "ok" : "FAULT", i.name, i.found);
        result.json["invariants"].push_back({{"name", i.name}, {"holds", i.holds}, {"found", i.found}});
    }
    if (stop_requested()) {
        throw CancelledError();
    }

    result.text += fmt::format("\n{:<42} {:>8}  {:>15}  {}\n", "dimension", "model", "published", "source");
    for (const patient::Dimension& d : patient::measure(patient, age_of(provenance, patient.weight))) {
        result.text += fmt::format("{:<42} {:>8.2f}  {:>6.1f} - {:<6.1f} {:<5}{}{}\n", d.name, d.value, d.low,
                                   d.high, d.unit, d.within() ? "" : "OUTSIDE ", d.source);
        result.json["dimensions"].push_back({{"name", d.name},
                                             {"value", d.value},
                                             {"unit", d.unit},
                                             {"published", {d.low, d.high}},
                                             {"within", d.within()},
                                             {"source", d.source}});
    }

    const patient::Alignment axes = patient::align_axes(patient, jaw_opening_deg * degree);
    const bool at_the_end = axes.head_elevation >= max_head_elevation - 1e-4f;
    result.text += fmt::format(
        "\nthe axes of mouth, pharynx and larynx align best at {:.1f} deg of head elevation{}, within {:.1f} "
        "mm (the patient of Xiao et al. 2020: 26 deg)\n",
        degrees(axes.head_elevation), at_the_end ? " (the end of the range)" : "", 1e3f * axes.off_line);
    const auto line = [&](const char* when, const patient::AxisAngles& a) {
        result.text += fmt::format(
            "{}: mouth to pharynx {:.0f} deg, pharynx to larynx {:.0f} deg, sight to larynx {:.0f} deg\n",
            when, degrees(a.mouth_pharynx), degrees(a.pharynx_larynx), degrees(a.sight_larynx));
    };
    line("head not raised", axes.angles_at_rest);
    line("head raised to that angle", axes.angles);
    result.text += "(adults, Adnet 2001, Anesthesiology 94:83: 87 -> 63, 7 -> 13)\n";
    const auto json_of = [&](const patient::AxisAngles& a) {
        return nlohmann::ordered_json{{"mouth_pharynx_deg", degrees(a.mouth_pharynx)},
                                      {"pharynx_larynx_deg", degrees(a.pharynx_larynx)},
                                      {"sight_larynx_deg", degrees(a.sight_larynx)}};
    };
    result.json["axes"] = {{"head_elevation_deg", degrees(axes.head_elevation)},
                           {"off_line_mm", static_cast<double>(1e3f * axes.off_line)},
                           {"at_rest", json_of(axes.angles_at_rest)},
                           {"raised", json_of(axes.angles)}};

    const std::size_t moving = static_cast<std::size_t>(std::count_if(
        patient.particles.mass.begin(), patient.particles.mass.end(), [](float m) { return m > 0; }));
    result.text +=
        fmt::format("\n{} particles ({} move), {} clusters, {} tetrahedra, {} links, {} surfaces\n",
                    patient.particles.size(), moving, patient.clusters.size(),
                    patient.tetrahedra.corners.size(), patient.links.ends.size(), patient.surfaces.size());
    result.json["counts"] = {
        {"particles", patient.particles.size()}, {"moving_particles", moving},
        {"clusters", patient.clusters.size()},   {"tetrahedra", patient.tetrahedra.corners.size()},
        {"links", patient.links.ends.size()},    {"surfaces", patient.surfaces.size()}};
    result.text += faults == 0 ? "valid\n" : fmt::format("{} faults\n", faults);
    result.json["sound"] = faults == 0;
    result.status = faults == 0 ? 0 : status_refused;
    return result;
}

}  // namespace

void add_check(CommandLine& app, Run& run) {
    CommandLine check = app.add_subcommand(
        "check", "Check a model: its invariants, and its dimensions beside published ones; fails on a fault");
    struct Typed {
        std::filesystem::path model;
        float jaw_opening_deg = 29.0f;
    };
    const auto typed = std::make_shared<Typed>();
    check.add_option("MODEL", typed->model, "Model written by 'build', or one from the server's cache")
        .required();
    check
        .add_number("--jaw-opening-deg", typed->jaw_opening_deg, "Jaw opening at which the axes are compared",
                    {0.0f, 35.0f, "deg"})
        .capture_default_str();
    check.callback(
        [typed, &run] { run = [typed] { return check_file(typed->model, typed->jaw_opening_deg); }; });
}

}  // namespace eti::tool
