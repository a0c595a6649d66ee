// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/grids/voxelise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/mesh/check.hpp"
#include "common/mesh/distance.hpp"
#include "server/patient/imaging/mesh_file.hpp"
#include "server/patient/segmentation/grids/label_distance.hpp"

namespace eti::segmentation {

namespace {

Label named(const std::filesystem::path& file) {
    if (const auto label = label_named(file.stem().string())) {
        return *label;
    }
    throw imaging::VolumeError(
        fmt::format("{}: its name does not indicate the structure; expected skin, airway, bone, mandible, "
                    "spine, tongue or epiglottis in it. Remedy: rename the file.",
                    file.string()));
}

/// Order of painting: later labels cover earlier ones.
constexpr std::array painting_order = {Label::soft,  Label::tongue,   Label::epiglottis, Label::bone,
                                       Label::spine, Label::mandible, Label::airway,     Label::enclosed_air};

std::ptrdiff_t painted_at(Label label) {
    return std::ranges::find(painting_order, label) - painting_order.begin();
}

struct Surface {
    Label label = Label::soft;
    TriangleMesh mesh;
};

Surface read_closed(const std::filesystem::path& file) {
    Surface surface{named(file), imaging::read_mesh(file)};
    const MeshReport report = check(surface.mesh);
    const std::size_t holes = report.open_edges + report.nonmanifold_edges + report.misoriented_edges;
    if (holes > 0) {
        const Vec3f at = 1e3f * report.fault_at.value_or(Vec3f::Zero());
        throw imaging::VolumeError(
            fmt::format("{}: {} open, {} non-manifold, {} misoriented edges, first near ({:.1f}, {:.1f}, "
                        "{:.1f}) mm; expected "
                        "a closed, oriented surface. Remedy: close its holes in the program that made it.",
                        file.string(), report.open_edges, report.nonmanifold_edges, report.misoriented_edges,
                        at.x(), at.y(), at.z()));
    }
    return surface;
}

/// A surface in another unit would become a few voxels without a larynx, or too many. `skin` is one of
/// `files`.
void require_size_of_a_patient(const TriangleMesh& skin, const std::vector<std::filesystem::path>& files) {
    Box box;
    for (const Vec3f& v : skin.vertices) {
        box.add(v.cast<double>());
    }
    const Vec3d size = 1e3 * (box.high - box.low);
    // [mm], from half the head of the smallest newborn to an adult.
    constexpr double least = 30.0, most = 2500.0;
    if (size.maxCoeff() >= least && size.maxCoeff() <= most) {
        return;
    }
    struct Unit {
        double millimetres;
        const char* name;
    };
    std::string guess;
    for (const Unit& unit : {Unit{1000.0, "metres"}, Unit{10.0, "centimetres"}, Unit{0.001, "micrometres"}}) {
        // A head, or a body; ten times the one is hardly the other.
        if (guess.empty() && size.maxCoeff() * unit.millimetres >= 60.0 &&
            size.maxCoeff() * unit.millimetres <= most) {
            guess =
                fmt::format(" The file seems to be in {}: scale it by {:g}.", unit.name, unit.millimetres);
        }
    }
    const auto file =
        std::ranges::find_if(files, [](const auto& path) { return named(path) == Label::soft; });
    throw imaging::VolumeError(fmt::format(
        "{}: the skin measures {:.3g} x {:.3g} x {:.3g} mm; expected {:g} to {:g} mm for the longest side. "
        "Remedy: export all surfaces in millimetres.{}",
        file->string(), size.x(), size.y(), size.z(), least, most, guess));
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    return ending == ".stl" || ending == ".obj" || ending == ".ply";
}

imaging::Mask voxelise(const std::vector<std::filesystem::path>& files, double spacing,
                       const Progress& progress) {
    std::vector<Surface> surfaces;
    Box box;
    for (const std::filesystem::path& file : files) {
        if (!progress(0.0f, "reading " + file.string())) {
            throw CancelledError();
        }
        surfaces.push_back(read_closed(file));
        for (const Vec3f& v : surfaces.back().mesh.vertices) {
            box.add(v.cast<double>());
        }
    }
    std::ranges::stable_sort(surfaces, {}, [](const Surface& surface) { return painted_at(surface.label); });
    if (surfaces.empty() || surfaces.front().label != Label::soft) {
        throw imaging::VolumeError(
            "there is no surface of the skin; expected one that encloses the others. Remedy: export it as "
            "well, named 'skin'.");
    }
    require_size_of_a_patient(surfaces.front().mesh, files);
    imaging::Mask labels;
    imaging::Geometry& g = labels.geometry;
    g.origin = box.low - Vec3d::Constant(2.0 * spacing);
    g.step = spacing * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
        g.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::min(1e5, std::ceil((box.high - box.low)[k] / spacing))) + 5;
    }
    imaging::require_valid(g, "surfaces");
    labels.value.assign(g.count(), value_of(Label::outside));
    for (const Surface& surface : surfaces) {
        if (!progress(0.05f, label_names[value_of(surface.label)])) {
            throw CancelledError();
        }
        const DistanceGrid distance =
            mesh_distance(surface.mesh, g.origin.cast<float>(), static_cast<float>(spacing), g.size,
                          static_cast<float>(spacing));
        for (std::size_t i = 0; i < labels.value.size(); ++i) {
            if (distance.value[i] < 0.0f) {
                labels.value[i] = value_of(surface.label);
            }
        }
    }
    return labels;
}

}  // namespace eti::segmentation
