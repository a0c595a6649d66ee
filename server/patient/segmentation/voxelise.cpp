// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/voxelise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/mesh/check.hpp"
#include "common/mesh/distance.hpp"
#include "server/patient/imaging/mesh_file.hpp"
#include "server/patient/segmentation/label_distance.hpp"

namespace eti::segmentation {

namespace {

struct Name {
    const char* word;
    Label label;
};
// In painting order: later labels cover earlier ones.
constexpr std::array<Name, 11> names = {{{"skin", Label::soft},
                                         {"body", Label::soft},
                                         {"head", Label::soft},
                                         {"tongue", Label::tongue},
                                         {"epiglottis", Label::epiglottis},
                                         {"bone", Label::bone},
                                         {"skull", Label::bone},
                                         {"spine", Label::spine},
                                         {"mandible", Label::mandible},
                                         {"jaw", Label::mandible},
                                         {"airway", Label::airway}}};

std::size_t named(const std::filesystem::path& file) {
    std::string stem = file.stem().string();
    std::ranges::transform(stem, stem.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (std::size_t k = names.size(); k-- > 0;) {
        if (stem.find(names[k].word) != std::string::npos) {
            return k;
        }
    }
    throw imaging::VolumeError(
        fmt::format("{}: its name does not indicate the structure; expected skin, airway, bone, mandible, "
                    "spine, tongue or epiglottis in it. Remedy: rename the file.",
                    file.string()));
}

struct Surface {
    std::size_t name = 0;
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
    std::ranges::stable_sort(surfaces, {}, &Surface::name);
    if (surfaces.empty() || names[surfaces.front().name].label != Label::soft) {
        throw imaging::VolumeError(
            "there is no surface of the skin; expected one that encloses the others. Remedy: export it as "
            "well, named 'skin'.");
    }
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
        const Name& name = names[surface.name];
        if (!progress(0.05f, name.word)) {
            throw CancelledError();
        }
        const DistanceGrid distance =
            mesh_distance(surface.mesh, g.origin.cast<float>(), static_cast<float>(spacing), g.size,
                          static_cast<float>(spacing));
        for (std::size_t i = 0; i < labels.value.size(); ++i) {
            if (distance.value[i] < 0.0f) {
                labels.value[i] = value_of(name.label);
            }
        }
    }
    return labels;
}

}  // namespace eti::segmentation
