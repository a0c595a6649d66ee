// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/math/units.hpp"
#include "common/process/command_line.hpp"
#include "common/process/escaped.hpp"
#include "common/process/stop_signal.hpp"
#include "server/patient/imaging/formats.hpp"
#include "server/patient/imaging/read.hpp"
#include "server/patient/segmentation/agreement.hpp"
#include "server/patient/segmentation/phantom.hpp"
#include "server/patient/segmentation/picture.hpp"
#include "server/patient/segmentation/placement/points_file.hpp"
#include "server/patient/segmentation/segment.hpp"
#include "server/patient/segmentation/surfaces.hpp"
#include "server/patient/tool/commands.hpp"

namespace {

using namespace eti;
using namespace eti::tool;
using std::filesystem::path;

path beside(const path& file, const std::string& what) {
    const std::string ending = file.string().substr(stem_of(file).string().size());
    return stem_of(file).string() + what + ending;
}

Result run_phantom(const PhantomSettings& settings, const path& out) {
    (void)imaging::format_of(out);
    const Phantom phantom = make_phantom(settings, progress);
    const path labels = beside(out, "-labels");
    const path landmarks = stem_of(out).string() + "-landmarks.mrk.json";
    (void)progress(1.0f, "writing");
    imaging::write(phantom.labels, labels);
    imaging::write_text(landmarks, encode_points(phantom.landmarks));
    imaging::write(phantom.ct, out);
    const auto& size = phantom.ct.geometry.size;
    Result result;
    result.text = fmt::format("{}: {} x {} x {} voxels of {:.3g} mm\n{}\n{}\n", out.string(), size[0],
                              size[1], size[2], 1e3f * settings.spacing, labels.string(), landmarks.string());
    result.json = {{"volume", out.string()},
                   {"labels", labels.string()},
                   {"landmarks", landmarks.string()},
                   {"size", size},
                   {"spacing_mm", 1e3f * settings.spacing}};
    return result;
}

constexpr const char* series_help =
    "Series Instance UID of the CT series in a DICOM folder [the one with most slices that forms a volume]";

struct SegmentRequest {
    path in;
    std::string series;
    path out;
    path landmarks;
    path truth;
    path picture;
    SegmentSettings settings;
};

Vec3d centre_of(const Segmentation& found) {
    if (const auto it = found.points.find("tongue"); it != found.points.end()) {
        return it->second.front();
    }
    // Without a tongue, the centre of the airway.
    Vec3d sum = Vec3d::Zero();
    double count = 0.0;
    const imaging::Geometry& g = found.labels.geometry;
    for (std::size_t i = 0; i < found.labels.value.size(); ++i) {
        if (found.labels.value[i] == value_of(Label::airway)) {
            const auto [x, y, z] = g.coordinates(i);
            sum += g.point(x, y, z);
            count += 1.0;
        }
    }
    return count > 0.0 ? Vec3d(sum / count) : g.point(0.5 * g.size[0], 0.5 * g.size[1], 0.5 * g.size[2]);
}

Result run_segment(SegmentRequest request) {
    (void)imaging::format_of(request.out);
    const Points given = read_landmarks(request.landmarks);
    const imaging::Volume ct = read_volume(request.in, request.series).volume;
    std::optional<imaging::Mask> truth;
    if (!request.truth.empty()) {
        truth = read_labels(request.truth);
    }
    Segmentation found;
    try {
        found = segment(ct, given, request.settings, progress);
    } catch (const imaging::VolumeError& error) {
        throw imaging::VolumeError(request.in.string() + ": " + error.what());
    }
    const path landmarks = stem_of(request.out).string() + "-landmarks.mrk.json";
    if (request.picture.empty()) {
        request.picture = stem_of(request.out).string() + ".png";
    }
    (void)progress(0.95f, "drawing");
    const imaging::Bytes png = imaging::encode_png(draw(ct, found.labels, centre_of(found)));
    if (stop_requested()) {
        throw CancelledError();
    }
    imaging::write_bytes(request.picture, png);
    imaging::write_text(landmarks, encode_points(found.points));
    imaging::write(found.labels, request.out);

    Result result;
    result.json = {{"labels", request.out.string()},
                   {"picture", request.picture.string()},
                   {"landmarks", landmarks.string()}};
    for (const Structure& s : found.structures) {
        const std::string millilitres = s.volume > 0.0 ? fmt::format("{:.1f} ml", 1e6 * s.volume) : "";
        result.text += fmt::format("{:<19} {:<6} {:>11}{}\n", s.name, s.found ? "found" : "absent",
                                   millilitres, s.note.empty() ? "" : "  " + s.note);
        result.json["structures"].push_back(
            {{"name", s.name}, {"found", s.found}, {"volume_ml", 1e6 * s.volume}, {"note", s.note}});
    }
    result.json["turn_deg"] = found.turn / static_cast<double>(degree);
    if (found.turn > 5.0 * static_cast<double>(degree)) {
        result.text += fmt::format("\nthe head is rotated by {:.0f} degrees from the file's directions\n",
                                   found.turn / static_cast<double>(degree));
    }
    result.json["noise_hu"] = found.noise;
    result.json["tongue_contrast_to_noise"] = std::isfinite(found.tongue_contrast_to_noise)
                                                  ? nlohmann::ordered_json(found.tongue_contrast_to_noise)
                                                  : nlohmann::ordered_json();
    result.json["contradictions"] = found.contradictions;
    result.json["uncertainties"] = found.uncertainties;
    for (const std::string& what : found.uncertainties) {
        remark("low confidence: " + what);
        result.status = status_uncertain;
    }
    for (const std::string& what : found.contradictions) {
        remark("doubtful: " + what);
        result.status = status_doubtful;
    }
    if (truth) {
        result.text += "\ncompared with truth   Dice  mean surface distance [voxels]\n";
        const std::array<std::pair<const char*, std::vector<Label>>, 5> compared = {
            {{"airway", {Label::airway}},
             {"bone", {Label::bone, Label::mandible, Label::spine}},
             {"mandible", {Label::mandible}},
             {"spine", {Label::spine}},
             {"tongue", {Label::tongue}}}};
        for (const auto& [name, labels] : compared) {
            const Agreement a = agreement(found.labels, *truth, labels);
            result.text += fmt::format(
                "{:<19} {:>6.3f}  {}\n", name, a.dice,
                a.mean_surface_distance
                    ? fmt::format("{:.2f}", *a.mean_surface_distance)
                    : fmt::format("none: only in {}", a.voxels_found > 0 ? "the result" : "the truth"));
            result.json["agreement"][name] = {
                {"dice", a.dice},
                {"mean_surface_distance_voxels", a.mean_surface_distance
                                                     ? nlohmann::ordered_json(*a.mean_surface_distance)
                                                     : nlohmann::ordered_json()}};
        }
    }
    result.text +=
        fmt::format("\n{}\n{}\n{}\n", request.out.string(), request.picture.string(), landmarks.string());
    return result;
}

Result run_surfaces(const path& in, const path& ct_file, const std::string& series, const path& folder,
                    const SurfaceSettings& settings) {
    const imaging::Mask labels = read_labels(in);
    std::optional<imaging::Volume> ct;
    if (!ct_file.empty()) {
        ct = read_volume(ct_file, series).volume;
    }
    std::vector<NamedSurface> surfaces;
    try {
        surfaces = make_surfaces(labels, ct ? &*ct : nullptr, settings, progress);
    } catch (const imaging::VolumeError& error) {
        throw imaging::VolumeError(in.string() + ": " + error.what());
    }
    if (surfaces.empty()) {
        throw imaging::VolumeError(
            in.string() +
            ": all labels are 0; expected a segmentation. Remedy: run eti-anatomy segment first.");
    }
    return write_surfaces(surfaces, folder);
}

}  // namespace

int main(int argc, char** argv) {
    CommandLine app(
        "Turns CT volumes into labels, surfaces and models; makes CT volumes of a parametric newborn.",
        "eti-anatomy");
    app.require_subcommand(1);
    app.fallthrough();
    bool json = false;
    app.add_flag("--json", json, "Print the result as one JSON object");

    CommandLine phantom = app.add_subcommand(
        "phantom",
        "Sample the parametric newborn to a CT volume, with its true labels and landmarks beside it");
    PhantomSettings phantom_settings;
    path phantom_out;
    double spacing_mm = 0.6;
    const ShapeOptions phantom_shape(phantom);
    double jaw_opening_deg = 0.0;
    phantom.add_number("--jaw-opening-deg", jaw_opening_deg, "Jaw opening in the volume", {0.0, 25.0, "deg"})
        .capture_default_str();
    phantom
        .add_number("--spacing-mm", spacing_mm, "Voxel spacing; half of it takes eight times as long",
                    {0.2, 3.0, "mm"})
        .capture_default_str();
    phantom
        .add_number("--noise-hu", phantom_settings.noise, "Standard deviation of the noise",
                    {0.0f, 200.0f, "HU"})
        .capture_default_str();
    double gantry_tilt_deg = 0.0;
    phantom
        .add_number("--gantry-tilt-deg", gantry_tilt_deg, "Tilt of the scanner's gantry about left-right",
                    {0.0, 30.0, "deg"})
        .capture_default_str();
    phantom.add_number("--seed", phantom_settings.seed, "Seed of the noise", {0}).capture_default_str();
    phantom.add_option("--out", phantom_out, "CT volume to write (.nrrd, .nii, .nii.gz)").required();

    CommandLine segment = app.add_subcommand(
        "segment",
        "Segment a CT of head and neck into labels: airway, bone, mandible, spine, tongue, soft tissue");
    SegmentRequest request;
    // The range of a scanner's twelve bits.
    const NumberLimits<float> hounsfield{-1024.0f, 3071.0f, "HU"};
    double closing_mm = 1e3 * static_cast<double>(request.settings.closing);
    segment.add_option("IN", request.in, "DICOM folder, NRRD, NIfTI or InVesalius project").required();
    segment.add_option("--series", request.series, series_help);
    segment.add_option("--out", request.out, "Labels to write (.nrrd, .nii, .nii.gz)").required();
    segment.add_option("--landmarks", request.landmarks,
                       "Points 'mandible', 'skull', 'spine', 'tongue', 'mouth' to start from instead of "
                       "those found (3D Slicer, *.mrk.json)");
    segment.add_option("--picture", request.picture,
                       "Picture of the result (default: beside the labels, .png)");
    segment.add_option("--truth", request.truth, "Labels to compare the result with");
    segment.add_number("--air-below-hu", request.settings.air_below, "Air is below", hounsfield)
        .capture_default_str();
    segment.add_number("--bone-above-hu", request.settings.bone_above, "Bone is above", hounsfield)
        .capture_default_str();
    segment
        .add_number("--closing-mm", closing_mm, "Radius of the ball that closes lips and nostrils",
                    {0.0, 30.0, "mm"})
        .capture_default_str();

    segment.footer(
        "Exit status: 0 labels that nothing contradicts; 1 refused; 2 wrong usage; 4 labels with "
        "contradictions "
        "(doubtful); 5 labels of low confidence, because of noise.");

    CommandLine surfaces = app.add_subcommand(
        "surfaces", "Turn labels into closed surfaces of skin, bone and airway (STL, in mm)");
    path labels;
    path ct;
    path folder;
    SurfaceSettings surface_settings;
    surfaces.add_option("LABELS", labels, "Labels written by 'segment', or with the same numbers").required();
    surfaces.add_option("--volume", ct, "The CT that was segmented: surfaces then follow its grey values");
    std::string ct_series;
    surfaces.add_option("--series", ct_series, series_help);
    surfaces.add_option("--out", folder, "Output folder; created if missing").required();
    const NumberLimits<std::size_t> triangles{4, 10'000'000, "triangles"};
    surfaces.add_number("--skin-triangles", surface_settings.skin_triangles, "At most so many", triangles)
        .capture_default_str();
    surfaces.add_number("--bone-triangles", surface_settings.bone_triangles, "At most so many", triangles)
        .capture_default_str();
    surfaces.add_number("--airway-triangles", surface_settings.airway_triangles, "At most so many", triangles)
        .capture_default_str();
    surfaces
        .add_number("--smoothing", surface_settings.smoothing, "Of the smoothing filter", {0, 100, "passes"})
        .capture_default_str();
    surfaces.add_number("--air-below-hu", surface_settings.air_below, "As given to 'segment'", hounsfield)
        .capture_default_str();
    surfaces.add_number("--bone-above-hu", surface_settings.bone_above, "As given to 'segment'", hounsfield)
        .capture_default_str();

    Run run;
    add_build(app, run);
    add_check(app, run);

    if (const auto status = app.parse(argc, argv)) {
        return *status;
    }
    catch_stop_signals();
    try {
        Result result;
        if (phantom.parsed()) {
            phantom_settings.spacing = static_cast<float>(1e-3 * spacing_mm);
            phantom_settings.gantry_tilt = static_cast<float>(gantry_tilt_deg) * degree;
            phantom_settings.newborn = phantom_shape.shape();
            phantom_settings.newborn.jaw_opening = static_cast<float>(jaw_opening_deg) * degree;
            result = run_phantom(phantom_settings, phantom_out);
        } else if (segment.parsed()) {
            request.settings.closing = static_cast<float>(1e-3 * closing_mm);
            result = run_segment(request);
        } else if (surfaces.parsed()) {
            result = run_surfaces(labels, ct, ct_series, folder, surface_settings);
        } else {
            result = run();
        }
        clear_progress();
        std::cout << (json ? result.json.dump(2) + "\n" : escaped_lines(result.text));
        return result.status;
    } catch (const CancelledError& error) {
        remark(error.what());
        return status_interrupted;
    } catch (const std::bad_alloc&) {
        remark("out of memory; crop the volume to head and neck, or choose wider spacing");
        return status_refused;
    } catch (const std::exception& error) {
        remark(stop_requested() ? "interrupted; nothing was written" : error.what());
        return stop_requested() ? status_interrupted : status_refused;
    }
}
