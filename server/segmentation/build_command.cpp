// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "common/math/units.hpp"
#include "server/anatomy/from_scenario.hpp"
#include "server/segmentation/commands.hpp"

namespace eti::segmentation {

namespace {

struct BuildRequest {
    std::string scenario;
    std::filesystem::path out;
    std::optional<float> spacing_mm, fine_spacing_mm, region_mm, stiffness_kpa;
};

anatomy::BuildSettings settings_of(const BuildRequest& request, anatomy::BuildSettings settings) {
    const auto take = [](const std::optional<float>& typed, float unit, float& to) {
        to = typed ? *typed * unit : to;
    };
    take(request.spacing_mm, millimetre, settings.spacing);
    take(request.fine_spacing_mm, millimetre, settings.fine_spacing);
    take(request.region_mm, millimetre, settings.region);
    take(request.stiffness_kpa, 1e3f, settings.tissue_stiffness);
    if (settings.fine_spacing > settings.spacing) {
        throw std::runtime_error(fmt::format("--fine-spacing-mm is {:g}; expected at most --spacing-mm, {:g}",
                                             settings.fine_spacing / millimetre,
                                             settings.spacing / millimetre));
    }
    return settings;
}

Result report(const anatomy::Patient& patient, const anatomy::Provenance& provenance,
              const std::filesystem::path& out) {
    Result result;
    result.text = fmt::format("{}: {:g} kg, {} particles, {} clusters, {} tetrahedra, {} surfaces\n",
                              out.string(), patient.weight, patient.particles.size(), patient.clusters.size(),
                              patient.tetrahedra.corners.size(), patient.surfaces.size());
    result.json = {{"model", out.string()},
                   {"weight_kg", patient.weight},
                   {"particles", patient.particles.size()},
                   {"clusters", patient.clusters.size()},
                   {"tetrahedra", patient.tetrahedra.corners.size()},
                   {"surfaces", patient.surfaces.size()},
                   {"provenance", provenance}};
    return result;
}

Result build_newborn(const BuildRequest& request, const ShapeOptions& options) {
    Scenario scenario;
    if (!request.scenario.empty()) {
        if (options.any()) {
            throw std::runtime_error("--scenario and options of the newborn's shape exclude each other");
        }
        scenario = load_scenario(find_data_file(request.scenario, "scenarios"));
        if (!scenario.patient.model.empty()) {
            throw std::runtime_error(fmt::format("scenario '{}' already names a model, {}", scenario.name,
                                                 scenario.patient.model.string()));
        }
    } else {
        scenario.patient.shape = options.shape();
    }
    const anatomy::BuildSettings settings = settings_of(request, anatomy::settings_of(scenario));
    (void)told(0.0f, "building the model");
    const anatomy::Patient patient = anatomy::build_patient(scenario.patient.shape, settings);
    if (!told(0.95f, "writing")) {
        throw Stopped();
    }
    const anatomy::Provenance provenance = anatomy::provenance_of(scenario.patient.shape, settings);
    anatomy::save_patient(patient, request.out, provenance);
    return report(patient, provenance, request.out);
}

}  // namespace

void add_build(CLI::App& app, Run& run) {
    CLI::App* const build = app.add_subcommand("build", "Build a model that eti-server runs");
    const auto request = std::make_shared<BuildRequest>();
    build->add_option("--scenario", request->scenario, "The newborn of a scenario, by name or path");
    const ShapeOptions shape(*build);
    build->add_option("--out", request->out, "Model to write (*.h5)")->required();
    build
        ->add_option("--spacing-mm", request->spacing_mm,
                     "Distance of particles in the bulk [2]; time grows with its inverse cube")
        ->check(CLI::Range(0.75, 4.0));
    build
        ->add_option("--fine-spacing-mm", request->fine_spacing_mm,
                     "Distance of particles at epiglottis and larynx [1]")
        ->check(CLI::Range(0.5, 2.0));
    build
        ->add_option("--region-mm", request->region_mm,
                     "Tissue farther than this from the airway only moves with the bones [10]")
        ->check(CLI::Range(4.0, 40.0));
    build
        ->add_option("--tissue-stiffness-kpa", request->stiffness_kpa,
                     "Young's modulus of tongue and mucosa [8]")
        ->check(CLI::Range(1.0, 100.0));
    build->callback(
        [request, shape, &run] { run = [request, shape] { return build_newborn(*request, shape); }; });
}

}  // namespace eti::segmentation
