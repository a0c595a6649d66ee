// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include "common/math/hash.hpp"
#include "common/math/units.hpp"
#include "common/process/command_line.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/newborn/build/check_model.hpp"
#include "server/patient/newborn/from_scenario.hpp"
#include "server/patient/segmentation/grids/voxelise.hpp"
#include "server/patient/segmentation/labelled_anatomy.hpp"
#include "server/patient/segmentation/placement/points_file.hpp"
#include "server/patient/segmentation/surfaces.hpp"
#include "server/patient/tool/commands.hpp"

namespace eti::tool {

namespace {

struct BuildRequest {
    std::vector<std::filesystem::path> in;
    std::filesystem::path landmarks;
    std::filesystem::path volume;
    std::string series;
    std::string scenario;
    std::filesystem::path out;
    std::optional<float> spacing_mm, fine_spacing_mm, surface_mm, region_mm, stiffness_kpa;
};

std::string stem_of_model(const std::filesystem::path& file) {
    return (file.parent_path() / file.stem()).string();
}

patient::BuildSettings settings_of(const BuildRequest& request, patient::BuildSettings settings) {
    const auto take = [](const std::optional<float>& typed, float unit, float& to) {
        to = typed ? *typed * unit : to;
    };
    take(request.spacing_mm, millimetre, settings.spacing);
    take(request.fine_spacing_mm, millimetre, settings.fine_spacing);
    take(request.surface_mm, millimetre, settings.surface_spacing);
    if (request.surface_mm) {
        // Scales the number of triangles with the surface's resolution.
        settings.body_triangles = static_cast<std::size_t>(static_cast<float>(settings.body_triangles) /
                                                           (*request.surface_mm * *request.surface_mm));
    }
    take(request.region_mm, millimetre, settings.region);
    take(request.stiffness_kpa, 1e3f, settings.tissue_stiffness);
    if (settings.fine_spacing > settings.spacing) {
        throw std::runtime_error(fmt::format("--fine-spacing-mm is {:g}; expected at most --spacing-mm, {:g}",
                                             settings.fine_spacing / millimetre,
                                             settings.spacing / millimetre));
    }
    return settings;
}

Result report(const patient::Patient& patient, const patient::Provenance& provenance,
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
    const patient::BuildSettings settings = settings_of(request, patient::settings_of(scenario));
    (void)progress(0.0f, "building the model");
    const patient::Patient patient = patient::build_patient(scenario.patient.shape, settings);
    if (!progress(0.95f, "writing")) {
        throw CancelledError();
    }
    const patient::Provenance provenance = patient::provenance_of(scenario.patient.shape, settings);
    patient::save_patient(patient, request.out, provenance);
    return report(patient, provenance, request.out);
}

/// Writes the surfaces of labels without a larynx, in place of a model.
Result write_surfaces_only(const BuildRequest& request, const imaging::Mask& labels, const std::string& why) {
    std::optional<imaging::Volume> ct;
    if (!request.volume.empty()) {
        ct = read_volume(request.volume, request.series).volume;
    }
    const std::filesystem::path folder = stem_of_model(request.out) + "-surfaces";
    Result result = write_surfaces(make_surfaces(labels, ct ? &*ct : nullptr, {}, progress), folder);
    result.text = fmt::format("no model: {}\nsurfaces of what the labels show:\n", why) + result.text;
    result.json["model"] = nullptr;
    result.json["why_no_model"] = why;
    result.status = status_no_model;
    return result;
}

Result build_labelled(const BuildRequest& request, const ShapeOptions& options) {
    if (options.any() || !request.scenario.empty()) {
        throw std::runtime_error(
            "labels define the patient's shape; omit --scenario and options of the newborn's shape");
    }
    const bool meshes = is_mesh_file(request.in.front());
    if (!meshes && request.in.size() > 1) {
        throw std::runtime_error(
            fmt::format("unexpected {}; expected one volume of labels, or surfaces (.stl, .obj, .ply)",
                        request.in[1].string()));
    }
    constexpr double mesh_voxels = 0.5e-3;  // [m]
    const imaging::Mask labels =
        meshes ? voxelise(request.in, mesh_voxels, progress) : read_labels(request.in.front());
    const Points given = read_landmarks(request.landmarks);
    const patient::BuildSettings settings = settings_of(request, {});
    (void)progress(0.1f, "registering a newborn to the labels");
    std::optional<LabelledAnatomy> anatomy;
    try {
        anatomy.emplace(labels, given, progress);
    } catch (const NoLarynxError& none) {
        return write_surfaces_only(request, labels, none.what());
    } catch (const imaging::VolumeError& error) {
        throw imaging::VolumeError(request.in.front().string() + ": " + error.what());
    }
    for (const std::string& text : anatomy->remarks()) {
        remark(text);
    }
    (void)progress(0.7f, "building the model");
    const patient::Patient patient = patient::build_patient(*anatomy, settings);
    for (const patient::Invariant& i : patient::check_model(patient)) {
        if (!i.holds) {
            throw std::runtime_error(
                fmt::format("{}: the labels result in no valid model: {}: {}; nothing was written. Remedy: "
                            "correct the labels there",
                            request.in.front().string(), i.name, i.found));
        }
    }
    if (!progress(0.95f, "writing")) {
        throw CancelledError();
    }
    patient::Provenance provenance = patient::provenance_of(settings);
    provenance["generator"] = meshes ? "surfaces" : "labels";
    for (const std::filesystem::path& file : request.in) {
        std::string& names = provenance["input"];
        std::string& hashes = provenance["input_fnv1a"];
        const char* comma = names.empty() ? "" : " ";
        names += fmt::format("{}{}", comma, file.filename().string());
        Hash hash;
        const imaging::Bytes bytes = imaging::read_bytes(file);
        hash.add(std::span(bytes));
        hashes += fmt::format("{}{:016x}", comma, hash.value());
    }
    provenance["weight_kg"] = fmt::format("{}", patient.weight);
    provenance["registration_off_mm"] = fmt::format("{:.3f}", 1e3 * anatomy->registration().off);
    patient::save_patient(patient, request.out, provenance);
    Result result = report(patient, provenance, request.out);
    result.text += fmt::format("a newborn differs from the labels by {:.2f} mm on average\n",
                               1e3 * anatomy->registration().off);
    return result;
}

}  // namespace

void add_build(CommandLine& app, Run& run) {
    CommandLine build = app.add_subcommand("build", "Build a model for eti-server");
    const auto request = std::make_shared<BuildRequest>();
    build.add_option("IN", request->in,
                     "Labels numbered as eti-anatomy's (.nrrd, .nii, .nii.gz), or closed surfaces (.stl, "
                     ".obj, .ply) named after their structures; without either, the parametric newborn");
    build.add_option("--landmarks", request->landmarks,
                     "Landmarks that override those found (3D Slicer, *.mrk.json), in the labels' frame");
    build.add_option("--volume", request->volume,
                     "The CT that was segmented: if no model can be built, surfaces follow its grey values");
    build.add_option("--series", request->series, "Series Instance UID of that CT in a DICOM folder");
    build.add_option("--scenario", request->scenario, "The newborn of a scenario, by name or path");
    const ShapeOptions shape(build);
    build.add_option("--out", request->out, "Model to write (*.h5)").required();
    build.add_number("--spacing-mm", request->spacing_mm,
                     "Distance of particles in the bulk [2]; time scales with its inverse cube",
                     {0.75f, 4.0f, "mm"});
    build.add_number("--fine-spacing-mm", request->fine_spacing_mm,
                     "Distance of particles at epiglottis and larynx [1]", {0.5f, 2.0f, "mm"});
    build.add_number(
        "--surface-mm", request->surface_mm,
        "Edges of the visible surfaces in the mouth [1]; finer at larynx and lips, coarser at the trunk",
        {0.7f, 1.5f, "mm"});
    build.add_number("--region-mm", request->region_mm,
                     "Tissue farther than this from the airway moves rigidly with the bones [10]",
                     {4.0f, 40.0f, "mm"});
    build.add_number("--tissue-stiffness-kpa", request->stiffness_kpa,
                     "Young's modulus of tongue and mucosa [8]", {1.0f, 100.0f, "kPa"});
    build.callback([request, shape, &run] {
        run = [request, shape] {
            return request->in.empty() ? build_newborn(*request, shape) : build_labelled(*request, shape);
        };
    });
}

}  // namespace eti::tool
