// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tissue.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <iterator>
#include <optional>
#include <utility>

#include "server/patient/model/stiffness.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "server/pbd/contact/surface_edges.hpp"
#include "server/pbd/soft/cluster_calibration.hpp"

namespace eti::scene {

namespace {

/// Input modulus [Pa] for a `wanted` one. Overlapping clusters are softer than each of them; strips of the
/// epiglottis are not calibrated.
float input_modulus_of(const patient::Patient& patient, std::uint32_t cluster, float wanted, float substep) {
    if (patient.clusters.tissue[cluster] == Tissue::epiglottis) {
        return wanted;
    }
    float spacing = 0.0f;  // the coarsest, where two lattices meet
    for (const std::uint32_t i : patient.clusters.members(cluster)) {
        spacing = std::max(spacing, 2.0f * patient.particles.radius[i]);
    }
    return pbd::calibrated_modulus({.spacing = spacing,
                                    .density = patient::tissue_density,
                                    .substep = substep,
                                    .load = pbd::ClusterLoad::tongue},
                                   wanted)
        .input_modulus;
}

// Of muscle and mucosa. Tetrahedra lock when nearly incompressible.
constexpr float hexahedron_poisson_ratio = 0.49f;
constexpr float tetrahedron_poisson_ratio = 0.45f;

// [spacings] from a cluster's centre. Clusters reach farther, and a surface drawn with the mean of all
// members does not follow a blade's dent (docs/decisions/skinning.md).
constexpr float fitted_reach = 1.75f;
// Fewer do not determine a rotation; every cluster has at least as many.
constexpr std::size_t fewest_members = 4;

/// A cluster's members within `reach` spacings of their centre; all members where those are too few.
std::vector<std::uint32_t> members_about_middle(const patient::Patient& patient, std::uint32_t cluster,
                                                float reach) {
    const patient::ParticleSet& set = patient.particles;
    const auto members = patient.clusters.members(cluster);
    const Vec3f& middle = patient.frame_rest_centre[patient::bone_count + cluster];
    std::vector<std::uint32_t> near;
    std::ranges::copy_if(members, std::back_inserter(near), [&](std::uint32_t i) {
        return (set.rest[i] - middle).norm() <= reach * 2.0f * set.radius[i];
    });
    return near.size() < fewest_members ? std::vector(members.begin(), members.end()) : near;
}

/// Whether a point lies in a tetrahedron at rest, or at its border.
bool lies_within(const std::vector<std::array<std::uint32_t, 4>>& solid, const std::vector<Vec3f>& rest,
                 const Vec3f& point) {
    constexpr float border = 1e-3f;  // barycentric
    return std::ranges::any_of(solid, [&](const auto& corner) {
        Eigen::Matrix3f edges;
        edges << rest[corner[1]] - rest[corner[0]], rest[corner[2]] - rest[corner[0]],
            rest[corner[3]] - rest[corner[0]];
        const Vec3f share = edges.inverse() * (point - rest[corner[0]]);
        return share.minCoeff() > -border && share.sum() < 1.0f + border;
    });
}

/// Extends strips of the epiglottis over their neighbours: a strip alone, a row of particles, holds neither
/// to the plate nor its own rotation.
void join_strips_of_epiglottis(const patient::Patient& patient, std::span<const std::uint32_t> wanted,
                               pbd::ShapeMatching::Description& shapes) {
    const patient::ClusterSet& clusters = patient.clusters;
    const pbd::ShapeMatching::Description alone = shapes;
    shapes.first.assign(1, 0);
    shapes.member.clear();
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        shapes.member.insert(shapes.member.end(), alone.member.begin() + alone.first[k],
                             alone.member.begin() + alone.first[k + 1]);
        const std::uint32_t c = wanted[k];
        for (const std::uint32_t n : {c - 1, c + 1}) {  // wraps below the first
            if (n < clusters.size() && clusters.tissue[c] == Tissue::epiglottis &&
                clusters.tissue[n] == Tissue::epiglottis) {
                const auto members = clusters.members(n);
                shapes.member.insert(shapes.member.end(), members.begin(), members.end());
            }
        }
        shapes.first.push_back(static_cast<std::uint32_t>(shapes.member.size()));
    }
}

/// The stiffness [N/m] of these links, of `all`.
std::vector<float> stiffness_of(std::span<const std::uint32_t> links, const std::vector<float>& all) {
    std::vector<float> out;
    for (const std::uint32_t l : links) {
        out.push_back(all[l]);
    }
    return out;
}

}  // namespace

SoftTissue::SoftTissue(const patient::Patient& patient, TissueMethod method, float substep)
    : patient_(patient), substep_(substep), soft_(patient.tissue_stiffness) {
    const patient::ParticleSet& set = patient.particles;
    body_.settings.damping = patient::tissue_damping;
    pbd::Particles& p = body_.particles;
    p.resize(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) {
        p.rest[i] = p.position[i] = p.predicted[i] = set.rest[i];
        p.inverse_mass[i] = set.mass[i] > 0.0f ? 1.0f / set.mass[i] : 0.0f;
        p.radius[i] = set.radius[i];
        p.object[i] = static_cast<std::uint8_t>(set.tissue[i]);
        p.channels[i] = pbd::channel::blade | pbd::channel::tube;
        if (set.tissue[i] == Tissue::tongue) {
            p.channels[i] |= pbd::channel::shell;
        }
    }
    // Where the tongue is attached to the floor of the mouth, links hold it, not the shell.
    for (const auto& ends : patient.links.ends) {
        p.channels[ends[0]] &= static_cast<std::uint8_t>(~pbd::channel::shell);
        p.channels[ends[1]] &= static_cast<std::uint8_t>(~pbd::channel::shell);
    }
    surface_edges_ = pbd::surface_edges(patient.tetrahedra.corners);
    std::erase_if(surface_edges_, [&](const auto& ends) {
        return p.inverse_mass[ends[0]] == 0.0f || p.inverse_mass[ends[1]] == 0.0f;
    });
    std::vector<bool> meshed(set.size(), false);
    if (method == TissueMethod::implicit) {
        meshed_ = patient::tetrahedra_of(Tissue::tongue, patient);
        std::ranges::copy(patient::tetrahedra_of(Tissue::epiglottis, patient), std::back_inserter(meshed_));
        cells_ = patient::cells_of(meshed_, patient);
    }
    for (const std::uint32_t t : meshed_) {
        for (const std::uint32_t i : patient.tetrahedra.corners[t]) {
            meshed[i] = true;
        }
    }
    // Clusters are needed for particles outside of tetrahedra and their neighbours; they also connect the
    // two.
    for (std::uint32_t c = 0; c < patient.clusters.size(); ++c) {
        const auto members = patient.clusters.members(c);
        const bool needed = std::ranges::any_of(
            members, [&](std::uint32_t i) { return !meshed[i] && p.inverse_mass[i] > 0.0f; });
        (needed ? held_clusters_ : fitted_clusters_).push_back(c);
    }
    pbd::ShapeMatching::Description held = description(held_clusters_, substep);
    join_strips_of_epiglottis(patient, held_clusters_, held);
    const std::vector<float> own = p.inverse_mass;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.inverse_mass[i] = meshed[i] ? 0.0f : own[i];  // clusters do not move the mesh's particles
    }
    body_.shapes.configure(held, p);
    p.inverse_mass = own;
    // A plate of whole cells is far stiffer than what it hangs on, so that exchanging forces from step to
    // step would drag on it. What attaches the tongue is as soft as the tongue.
    const bool plate = std::ranges::none_of(cells_.tetrahedra, [&](const auto& corners) {
        return std::ranges::any_of(corners,
                                   [&](std::uint32_t i) { return set.tissue[i] == Tissue::epiglottis; });
    });
    pbd::ImplicitMesh::Links links_of_mesh;
    std::vector<pbd::Links::Pair> links_of_substeps;
    for (std::uint32_t l = 0; l < patient.links.ends.size(); ++l) {
        const auto& ends = patient.links.ends[l];
        const bool of_plate = plate && std::ranges::any_of(ends, [&](std::uint32_t i) {
                                  return meshed[i] && set.tissue[i] == Tissue::epiglottis;
                              });
        (of_plate ? mesh_links_ : substep_links_).push_back(l);
        (of_plate ? links_of_mesh.ends : links_of_substeps).push_back(ends);
    }
    links_of_mesh.stiffness = stiffness_of(mesh_links_, patient.links.stiffness);
    if (method == TissueMethod::implicit) {
        pbd::ImplicitMesh::Description mesh;
        fill_moduli(patient.tissue_stiffness);
        mesh.tetrahedra = {cells_.tetrahedra, tetrahedron_moduli_, tetrahedron_poisson_ratio};
        mesh.hexahedra = {cells_.hexahedra, hexahedron_moduli_, hexahedron_poisson_ratio};
        mesh.links = std::move(links_of_mesh);
        tongue_.configure(mesh, surface_of_mesh(meshed), p, substep);
        tongue_.keep_apart(solid());
    }
    fitted_.configure(description(fitted_clusters_, substep, fitted_reach), p);
    drawn_.configure(patient, meshed_);
    body_.links.configure(std::move(links_of_substeps), stiffness_of(substep_links_, patient.links.stiffness),
                          p);

    const patient::ClusterSet& clusters = patient.clusters;
    const std::vector<patient::BoneWeights> of_frame = patient::frame_bones(patient);
    const auto first = of_frame.begin() + patient::bone_count;
    cluster_bones_.assign(first, first + static_cast<std::ptrdiff_t>(clusters.size()));
    cluster_turn_.resize(clusters.size());
    cluster_posed_centre_.resize(clusters.size());
    pose(patient::pose_bones(patient.skeleton, {}));
    reset();
}

TongueContacts::Surface SoftTissue::surface_of_mesh(const std::vector<bool>& meshed) const {
    TongueContacts::Surface surface;
    std::vector<bool> on_triangle(meshed.size(), false);
    std::vector<std::array<std::uint32_t, 4>> tetrahedra;
    for (const std::uint32_t t : meshed_) {
        tetrahedra.push_back(patient_.tetrahedra.corners[t]);
    }
    surface.triangles = pbd::surface_triangles(tetrahedra);
    for (const auto& triangle : surface.triangles) {
        for (const std::uint32_t i : triangle) {
            on_triangle[i] = true;
        }
    }
    // Inner particles meet the blade, too, where it has crushed the cells above them.
    for (std::uint32_t i = 0; i < meshed.size(); ++i) {
        if (meshed[i] && !on_triangle[i]) {
            surface.particles.push_back(i);
        }
    }
    return surface;
}

SelfContactFinder::Description SoftTissue::solid() const {
    const pbd::Particles& p = body_.particles;
    SelfContactFinder::Description out;
    out.rest = patient_.particles.rest;
    out.free.resize(p.size(), false);
    std::vector<bool> of_solid(p.size(), false);
    for (const std::uint32_t t : patient::tetrahedra_of(Tissue::tongue, patient_)) {
        out.solid.push_back(patient_.tetrahedra.corners[t]);
        for (const std::uint32_t i : out.solid.back()) {
            of_solid[i] = true;
        }
    }
    for (const auto& triangle : pbd::surface_triangles(out.solid)) {
        for (const std::uint32_t i : triangle) {
            // Links, not the surface, attach the tongue's floor.
            out.free[i] = tongue_.moves(i) && (p.channels[i] & pbd::channel::shell) != 0;
        }
    }
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        if (tongue_.moves(i) && !of_solid[i] && !lies_within(out.solid, out.rest, out.rest[i])) {
            out.neighbours.push_back(i);
        }
    }
    return out;
}

pbd::ShapeMatching::Description SoftTissue::description(std::span<const std::uint32_t> wanted, float substep,
                                                        float reach) const {
    const patient::ParticleSet& set = patient_.particles;
    pbd::ShapeMatching::Description shapes;
    for (const float radius : set.radius) {
        const float volume = 8.0f * radius * radius * radius;
        shapes.particle_volume.push_back(volume);
        shapes.fitting_mass.push_back(patient::tissue_density * volume);
    }
    shapes.first.push_back(0);
    for (const std::uint32_t c : wanted) {
        const std::vector<std::uint32_t> members = members_about_middle(patient_, c, reach);
        shapes.member.insert(shapes.member.end(), members.begin(), members.end());
        shapes.first.push_back(static_cast<std::uint32_t>(shapes.member.size()));
        shapes.youngs_modulus.push_back(
            input_modulus_of(patient_, c, patient_.clusters.youngs_modulus[c], substep));
    }
    return shapes;
}

void SoftTissue::pose(const patient::BonePoses& bones) {
    bones_ = bones;
    pbd::Particles& p = body_.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.rest[i] = patient::pose_point(grown(i), patient_.particles.bones[i], bones);
    }
    body_.set_rest();
    tongue_.set_rest(p);
    fitted_.set_rest(p);
    for (std::size_t c = 0; c < cluster_turn_.size(); ++c) {
        cluster_turn_[c] = patient::pose_rotation(cluster_bones_[c], bones);
        Vec3f centre = patient_.frame_rest_centre[patient::bone_count + c];
        if (growth_ != 1.0f) {
            centre += (growth_ - 1.0f) * cluster_swelling_[c];
        }
        cluster_posed_centre_[c] = patient::pose_point(centre, cluster_bones_[c], bones);
    }
}

Vec3f SoftTissue::grown(std::size_t particle) const {
    const Vec3f& built = patient_.particles.rest[particle];
    return growth_ == 1.0f ? built : Vec3f(built + (growth_ - 1.0f) * swelling_[particle]);
}

void SoftTissue::set_swelling(std::vector<Vec3f> displacement) {
    assert(displacement.size() == body_.particles.size());
    swelling_ = std::move(displacement);
    cluster_swelling_.assign(patient_.clusters.size(), Vec3f::Zero());
    for (std::uint32_t c = 0; c < patient_.clusters.size(); ++c) {
        const auto members = patient_.clusters.members(c);
        for (const std::uint32_t i : members) {
            cluster_swelling_[c] += swelling_[i] / static_cast<float>(members.size());
        }
    }
}

void SoftTissue::set_tongue_growth(float growth) {
    assert(has_swelling());
    growth_ = growth;
    update_moduli();
}

void SoftTissue::set_stiffness(float soft) {
    soft_ = soft;
    update_moduli();
}

void SoftTissue::fill_moduli(float soft) {
    tetrahedron_moduli_.clear();
    for (const auto& corners : cells_.tetrahedra) {
        tetrahedron_moduli_.push_back(patient::mean_modulus(patient_, corners, soft));
    }
    hexahedron_moduli_.clear();
    for (const auto& corners : cells_.hexahedra) {
        hexahedron_moduli_.push_back(patient::mean_modulus(patient_, corners, soft));
    }
}

void SoftTissue::update_moduli() {
    body_.sleep.wake_all(body_.particles);
    if (!tongue_.empty()) {
        fill_moduli(soft_);
        tongue_.set_youngs_modulus(tetrahedron_moduli_, hexahedron_moduli_, body_.particles);
    }
    moduli_.clear();
    for (const std::uint32_t c : held_clusters_) {
        // A cluster's springs scale with its size (E V / r^2), as a tetrahedron's do with its rest shape.
        const float size = patient_.clusters.tissue[c] == Tissue::tongue ? growth_ : 1.0f;
        moduli_.push_back(
            size * input_modulus_of(patient_, c, patient::cluster_modulus(patient_, c, soft_), substep_));
    }
    body_.shapes.set_youngs_modulus(moduli_);
    std::vector<float> of_links;
    for (std::uint32_t l = 0; l < patient_.links.ends.size(); ++l) {
        of_links.push_back(patient::link_stiffness(patient_, l, soft_));
    }
    body_.links.set_stiffness(stiffness_of(substep_links_, of_links));
    tongue_.set_link_stiffness(stiffness_of(mesh_links_, of_links));
}

void SoftTissue::enable_sleeping() {
    body_.enable_sleeping(tongue_.moved(), {});
}

void SoftTissue::frames(std::vector<FramePose>& frames, float head_size) {
    frames.resize(patient_.frame_rest_centre.size());
    for (std::size_t b = 0; b < patient::bone_count; ++b) {
        frames[b] = {bones_[b] * patient_.frame_rest_centre[b], bones_[b].rotation};
    }
    // If so, sleeping clusters are rewritten, too: the correction shifts frames from their fit.
    const bool mesh_awake = body_.sleep.mesh_awake() || body_.sleep.held_awake();
    constexpr std::size_t block = pbd::ShapeMatching::block_size;
    for (std::size_t first = 0; first < held_clusters_.size(); first += block) {
        if (mesh_awake || body_.sleep.block_awake(first / block)) {
            frames_of(body_.shapes, held_clusters_, first, std::min(first + block, held_clusters_.size()),
                      frames);
        }
    }
    if (mesh_awake) {
        fitted_.fit(body_.particles.position);
        frames_of(fitted_, fitted_clusters_, 0, fitted_clusters_.size(), frames);
        drawn_.shift(body_.particles.position, frames);
    }
    const RigidTransform& skull = bones_[static_cast<std::size_t>(patient::Bone::skull)];
    for (std::size_t f = patient::bone_count + cluster_turn_.size(); f < frames.size(); ++f) {
        frames[f] = {skull * (head_size * patient_.frame_rest_centre[f]), skull.rotation};
    }
}

void SoftTissue::frames_of(const pbd::ShapeMatching& shapes, std::span<const std::uint32_t> clusters,
                           std::size_t first, std::size_t end, std::vector<FramePose>& frames) const {
    for (std::size_t k = first; k < end; ++k) {
        const std::uint32_t c = clusters[k];
        const Quatf rotation = shapes.rotation()[k];
        frames[patient::bone_count + c] = {
            rotation * (cluster_posed_centre_[c] - shapes.rest_centre()[k]) + shapes.centre()[k],
            (rotation * cluster_turn_[c]).normalized()};
    }
}

void SoftTissue::reset() {
    body_.reset();
    tongue_.reset(body_.particles);
    fitted_.reset();
}

}  // namespace eti::scene
