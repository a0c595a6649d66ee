// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/model_file.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "common/hdf5/file.hpp"
#include "common/hdf5/packing.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/file_kind.hpp"

namespace eti::patient {

namespace {

using hdf5::any_extent;
using hdf5::Group;
using hdf5::numbers_of;
using hdf5::read_rows;
using hdf5::write_rows;

constexpr std::string_view file_kind = "NeoETI patient model";
constexpr std::uint64_t schema = 4;

void write_carried(const Group& parent, const std::string& name, std::span<const CarriedPoint> points) {
    const Group group = parent.create(name);
    std::vector<Vec3f> rest;
    std::vector<SkinWeights> skin;
    for (const CarriedPoint& point : points) {
        rest.push_back(point.rest);
        skin.push_back(point.skin);
    }
    write_rows(group, "rest", rest, {"m", "rest posture, patient frame"});
    write_skin(group, skin);
}

std::vector<CarriedPoint> read_carried(const Group& group, std::size_t count, std::size_t frames) {
    const auto rest = read_rows<Vec3f>(group, "rest", count);
    require_finite(group, "rest", numbers_of(rest));
    const auto skin = read_skin(group, rest.size());
    require_skin(group, skin, frames);
    std::vector<CarriedPoint> points(rest.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = {rest[i], skin[i]};
    }
    return points;
}

void require_above(const Group& group, const std::string& name, std::span<const float> values,
                   bool zero_too) {
    require_finite(group, name, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] < 0.0f || (values[i] == 0.0f && !zero_too)) {
            throw hdf5::Error(fmt::format("{}: value {} is {}; expected {}", group.at(name), i, values[i],
                                          zero_too ? "zero or more" : "more than zero"));
        }
    }
}

void require_bone_weights(const Group& group, const std::string& name,
                          const std::vector<BoneWeights>& weights) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
        float sum = 0.0f;
        for (const float weight : weights[i]) {
            if (!(weight >= -1e-3f)) {
                sum = std::nanf("");
            }
            sum += weight;
        }
        if (!(std::abs(sum - 1.0f) <= 1e-3f)) {  // as for skin weights
            throw hdf5::Error(
                fmt::format("{}: the weights in row {} are not parts of one", group.at(name), i));
        }
    }
}

std::vector<float> numbers(const Group& group, const std::string& name, std::size_t count) {
    return group.read<float>(name, {count}).values;
}

void write(const Group& group, const ParticleSet& particles) {
    write_rows(group, "rest", particles.rest, {"m", "rest position, patient frame"});
    group.write<float>("mass", particles.mass, {particles.mass.size()}, {"kg", "0: moves with the bones"});
    group.write<float>("radius", particles.radius, {particles.radius.size()}, {"m", "contact radius"});
    write_tissues(group, "tissue", particles.tissue);
    write_rows(group, "bones", particles.bones, {"1", "weights of trunk, skull and mandible"});
}

ParticleSet read_particles(const Group& group) {
    ParticleSet particles;
    particles.rest = read_rows<Vec3f>(group, "rest");
    const std::size_t count = particles.size();
    particles.mass = numbers(group, "mass", count);
    particles.radius = numbers(group, "radius", count);
    particles.tissue = read_tissues(group, "tissue", count);
    particles.bones = read_rows<BoneWeights>(group, "bones", count);
    require_finite(group, "rest", numbers_of(particles.rest));
    require_above(group, "mass", particles.mass, true);
    require_above(group, "radius", particles.radius, true);
    require_bone_weights(group, "bones", particles.bones);
    return particles;
}

void write(const Group& group, const ClusterSet& clusters) {
    group.write<std::uint32_t>("first", clusters.first, {clusters.first.size()},
                               {"1", "row in member where each cluster begins; the last entry is the end"});
    group.write<std::uint32_t>("member", clusters.member, {clusters.member.size()},
                               {"1", "particle indices"});
    group.write<float>("youngs_modulus", clusters.youngs_modulus, {clusters.youngs_modulus.size()},
                       {"Pa", "Young's modulus"});
    write_tissues(group, "tissue", clusters.tissue);
}

ClusterSet read_clusters(const Group& group, std::size_t particles) {
    ClusterSet clusters;
    clusters.first = group.read<std::uint32_t>("first", {any_extent}).values;
    clusters.member = group.read<std::uint32_t>("member", {any_extent}).values;
    clusters.youngs_modulus = numbers(group, "youngs_modulus", clusters.size());
    clusters.tissue = read_tissues(group, "tissue", clusters.size());
    const auto& first = clusters.first;
    if (first.empty() ? !clusters.member.empty()
                      : first.front() != 0 || first.back() != clusters.member.size()) {
        throw hdf5::Error(
            fmt::format("{}: does not start at 0 and end at the number of members", group.at("first")));
    }
    for (std::size_t i = 1; i < first.size(); ++i) {
        if (first[i] < first[i - 1]) {
            throw hdf5::Error(
                fmt::format("{}: value {} is less than the previous one", group.at("first"), i));
        }
    }
    require_indices(group, "member", clusters.member, particles, "particles");
    require_above(group, "youngs_modulus", clusters.youngs_modulus, false);
    return clusters;
}

void write(const Group& group, const TetrahedronSet& tetrahedra) {
    write_rows(group, "corners", tetrahedra.corners, {"1", "particle indices"});
    group.write<float>("youngs_modulus", tetrahedra.youngs_modulus, {tetrahedra.youngs_modulus.size()},
                       {"Pa", "Young's modulus"});
}

TetrahedronSet read_tetrahedra(const Group& group, std::size_t particles) {
    TetrahedronSet tetrahedra;
    tetrahedra.corners = read_rows<std::array<std::uint32_t, 4>>(group, "corners");
    tetrahedra.youngs_modulus = numbers(group, "youngs_modulus", tetrahedra.corners.size());
    require_indices(group, "corners", numbers_of(tetrahedra.corners), particles, "particles");
    require_above(group, "youngs_modulus", tetrahedra.youngs_modulus, false);
    return tetrahedra;
}

void write(const Group& group, const LinkSet& links) {
    write_rows(group, "ends", links.ends, {"1", "particle indices"});
    group.write<float>("stiffness", links.stiffness, {links.stiffness.size()}, {"N/m", "stiffness"});
}

LinkSet read_links(const Group& group, std::size_t particles) {
    LinkSet links;
    links.ends = read_rows<std::array<std::uint32_t, 2>>(group, "ends");
    links.stiffness = numbers(group, "stiffness", links.ends.size());
    require_indices(group, "ends", numbers_of(links.ends), particles, "particles");
    require_above(group, "stiffness", links.stiffness, true);
    return links;
}

void write(const Group& group, const Shell& shell) {
    write_mesh(group, shell.mesh);
    write_tissues(group, "triangle_tissue", shell.triangle_tissue);
    write_rows(group, "vertex_bones", shell.vertex_bones, {"1", "weights of trunk, skull and mandible"});
    const DistanceGrid& grid = shell.distance;
    group.write<float>("origin", {grid.origin.data(), 3}, {3}, {"m", "node (0, 0, 0) of the distance grid"});
    group.set_number("spacing_m", static_cast<double>(grid.spacing));
    group.write<float>("distance", grid.value,
                       {static_cast<std::size_t>(grid.size[2]), static_cast<std::size_t>(grid.size[1]),
                        static_cast<std::size_t>(grid.size[0])},
                       {"m", "signed distance at node (z, y, x), negative inside the tissue"});
}

Shell read_shell(const Group& group) {
    Shell shell;
    shell.mesh = read_mesh(group);
    shell.triangle_tissue = read_tissues(group, "triangle_tissue", shell.mesh.triangles.size());
    shell.vertex_bones = read_rows<BoneWeights>(group, "vertex_bones", shell.mesh.vertices.size());
    require_bone_weights(group, "vertex_bones", shell.vertex_bones);
    const auto origin = numbers(group, "origin", 3);
    require_finite(group, "origin", origin);
    shell.distance.origin = {origin[0], origin[1], origin[2]};
    shell.distance.spacing = static_cast<float>(group.number("spacing_m"));
    if (!(shell.distance.spacing > 0.0f && std::isfinite(shell.distance.spacing))) {
        throw hdf5::Error(fmt::format("{}: attribute spacing_m is {}; expected more than zero", group.place(),
                                      shell.distance.spacing));
    }
    auto distance = group.read<float>("distance", {any_extent, any_extent, any_extent});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        shell.distance.size[axis] = static_cast<int>(distance.shape[2 - axis]);
    }
    require_finite(group, "distance", distance.values);
    shell.distance.value = std::move(distance.values);
    return shell;
}

void write(const Group& root, const Patient& patient) {
    root.set_number("weight_kg", static_cast<double>(patient.weight));
    root.set_number("tissue_stiffness_pa", static_cast<double>(patient.tissue_stiffness));
    const Group skeleton = root.create("skeleton");
    skeleton.write<float>("neck_joint", {patient.skeleton.neck_joint.data(), 3}, {3}, {"m", "patient frame"});
    skeleton.write<float>("jaw_joint", {patient.skeleton.jaw_joint.data(), 3}, {3}, {"m", "patient frame"});
    skeleton.set_number("jaw_slide_m_per_rad", static_cast<double>(patient.skeleton.jaw_slide_per_radian));
    write(root.create("particles"), patient.particles);
    write(root.create("clusters"), patient.clusters);
    write(root.create("tetrahedra"), patient.tetrahedra);
    write(root.create("links"), patient.links);
    write_rows(root, "frame_rest_centre", patient.frame_rest_centre,
               {"m", "bones first, then clusters, then the head's"});
    const Group surfaces = root.create("surfaces");
    surfaces.set_integer("count", patient.surfaces.size());
    for (std::size_t i = 0; i < patient.surfaces.size(); ++i) {
        write_surface(surfaces.create(std::to_string(i)), patient.surfaces[i]);
    }
    write(root.create("shell"), patient.shell);
    write_carried(root, "landmarks", patient.landmarks);
    write_carried(root, "glottis_contour", patient.glottis_contour);
}

Vec3f read_point(const Group& group, const std::string& name) {
    const auto point = numbers(group, name, 3);
    require_finite(group, name, point);
    return {point[0], point[1], point[2]};
}

Patient read(const Group& root) {
    Patient patient;
    patient.weight = static_cast<float>(root.number("weight_kg"));
    patient.tissue_stiffness = static_cast<float>(root.number("tissue_stiffness_pa"));
    const Group skeleton = root.open("skeleton");
    patient.skeleton = {read_point(skeleton, "neck_joint"), read_point(skeleton, "jaw_joint"),
                        static_cast<float>(skeleton.number("jaw_slide_m_per_rad"))};
    if (!(patient.weight > 0.0f) || !std::isfinite(patient.weight) || !(patient.tissue_stiffness > 0.0f) ||
        !std::isfinite(patient.tissue_stiffness) || !std::isfinite(patient.skeleton.jaw_slide_per_radian)) {
        throw hdf5::Error(
            fmt::format("{}: weight, tissue stiffness or jaw slide is not a usable number", root.place()));
    }
    patient.particles = read_particles(root.open("particles"));
    patient.clusters = read_clusters(root.open("clusters"), patient.particles.size());
    patient.tetrahedra = read_tetrahedra(root.open("tetrahedra"), patient.particles.size());
    patient.links = read_links(root.open("links"), patient.particles.size());
    const std::size_t frames = bone_count + patient.clusters.size();
    const std::size_t all_frames = frames + head_frame_count;
    patient.frame_rest_centre = read_rows<Vec3f>(root, "frame_rest_centre", all_frames);
    require_finite(root, "frame_rest_centre", numbers_of(patient.frame_rest_centre));
    const Group surfaces = root.open("surfaces");
    const std::size_t count = surfaces.integer("count");
    if (surfaces.members().size() != count) {
        throw hdf5::Error(fmt::format("{}: contains {} surfaces, but its count is {}", surfaces.place(),
                                      surfaces.members().size(), count));
    }
    for (std::size_t i = 0; i < count; ++i) {
        patient.surfaces.push_back(read_surface(surfaces.open(std::to_string(i)), all_frames));
    }
    patient.shell = read_shell(root.open("shell"));
    const auto landmarks = read_carried(root.open("landmarks"), landmark_count, frames);
    std::copy(landmarks.begin(), landmarks.end(), patient.landmarks.begin());
    patient.glottis_contour = read_carried(root.open("glottis_contour"), any_extent, frames);
    return patient;
}

hdf5::File open_model(const std::filesystem::path& path) {
    hdf5::File file = hdf5::File::open(path, hdf5::Access::read);
    const auto names = file.root().attributes();
    if (std::find(names.begin(), names.end(), "kind") == names.end() ||
        file.root().text("kind") != file_kind) {
        throw hdf5::Error(fmt::format("{}: not a patient model of this program", path.string()));
    }
    const std::uint64_t found = file.root().integer("schema");
    if (found != schema) {
        throw hdf5::Error(fmt::format("{}: the model has schema {}, this program reads {}; rebuild the model",
                                      path.string(), found, schema));
    }
    return file;
}

}  // namespace

void save_patient(const Patient& patient, const std::filesystem::path& path, const Provenance& provenance) {
    if (const std::string kind = describe_blocking_entry(path); !kind.empty()) {
        throw hdf5::Error(fmt::format("{}: is {}, expected a file or a new name; choose another name",
                                      path.string(), kind));
    }
    // Two servers may build the same model concurrently.
    AtomicFileWriter unfinished(path);
    hdf5::File file = hdf5::File::create(unfinished.path());
    file.root().set_text("kind", file_kind);
    file.root().set_integer("schema", schema);
    const Group origin = file.root().create("provenance");
    for (const auto& [key, value] : provenance) {
        origin.set_text(key, value);
    }
    write(file.root(), patient);
    file.close();
    (void)load_patient(unfinished.path());
    unfinished.finish();
}

Patient load_patient(const std::filesystem::path& path) {
    const hdf5::File file = open_model(path);
    return read(file.root());
}

Provenance load_provenance(const std::filesystem::path& path) {
    const hdf5::File file = open_model(path);
    const Group group = file.root().open("provenance");
    Provenance provenance;
    for (const std::string& key : group.attributes()) {
        provenance[key] = group.text(key);
    }
    return provenance;
}

}  // namespace eti::patient
