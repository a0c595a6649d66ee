// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tissue.hpp"

namespace eti::scene {

SoftTissue::SoftTissue(const anatomy::Patient& patient) : patient_(patient) {
    const anatomy::ParticleSet& set = patient.particles;
    pbd::Particles& p = body_.particles;
    p.resize(set.size());
    pbd::ShapeMatching::Description shapes;
    shapes.particle_volume.resize(set.size());
    shapes.fitting_mass.resize(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) {
        p.rest[i] = p.position[i] = p.predicted[i] = set.rest[i];
        p.inverse_mass[i] = set.mass[i] > 0.0f ? 1.0f / set.mass[i] : 0.0f;
        p.radius[i] = set.radius[i];
        p.object[i] = static_cast<std::uint8_t>(set.tissue[i]);
        p.channels[i] = pbd::channel::blade | pbd::channel::tube;
        if (set.tissue[i] == Tissue::tongue) {
            p.channels[i] |= pbd::channel::shell;
        }
        const float spacing = 2.0f * set.radius[i];
        shapes.particle_volume[i] = spacing * spacing * spacing;
        shapes.fitting_mass[i] = anatomy::tissue_density * shapes.particle_volume[i];
    }
    // Where the tongue grows out of the mouth floor, links hold it, not the shell.
    for (const auto& ends : patient.links.ends) {
        p.channels[ends[0]] &= static_cast<std::uint8_t>(~pbd::channel::shell);
        p.channels[ends[1]] &= static_cast<std::uint8_t>(~pbd::channel::shell);
    }
    shapes.first = patient.clusters.first;
    shapes.member = patient.clusters.member;
    shapes.youngs_modulus = patient.clusters.youngs_modulus;
    body_.shapes.configure(shapes, p);
    body_.links.configure(patient.links.ends, patient.links.stiffness, p);

    const anatomy::ClusterSet& clusters = patient.clusters;
    cluster_bones_.resize(clusters.size());
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        anatomy::BoneWeights mean{};
        for (std::uint32_t k = clusters.first[c]; k < clusters.first[c + 1]; ++k) {
            for (std::size_t b = 0; b < anatomy::bone_count; ++b) {
                mean[b] += set.bones[clusters.member[k]][b];
            }
        }
        for (float& w : mean) {
            w /= static_cast<float>(clusters.first[c + 1] - clusters.first[c]);
        }
        cluster_bones_[c] = mean;
    }
    cluster_turn_.resize(clusters.size());
    cluster_posed_centre_.resize(clusters.size());
    pose(anatomy::pose_bones(patient.skeleton, {}));
    reset();
}

void SoftTissue::pose(const anatomy::BonePoses& bones) {
    bones_ = bones;
    pbd::Particles& p = body_.particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.rest[i] = anatomy::pose_point(patient_.particles.rest[i], patient_.particles.bones[i], bones);
    }
    body_.set_rest();
    for (std::size_t c = 0; c < cluster_turn_.size(); ++c) {
        cluster_turn_[c] = anatomy::pose_rotation(cluster_bones_[c], bones);
        cluster_posed_centre_[c] = anatomy::pose_point(patient_.frame_rest_centre[anatomy::bone_count + c],
                                                       cluster_bones_[c], bones);
    }
}

void SoftTissue::frames(std::vector<FramePose>& frames) const {
    frames.resize(anatomy::bone_count + cluster_turn_.size());
    for (std::size_t b = 0; b < anatomy::bone_count; ++b) {
        frames[b] = {bones_[b] * patient_.frame_rest_centre[b], bones_[b].rotation};
    }
    const pbd::ShapeMatching& shapes = body_.shapes;
    for (std::size_t c = 0; c < cluster_turn_.size(); ++c) {
        const Quatf rotation = shapes.rotation()[c];
        frames[anatomy::bone_count + c] = {
            rotation * (cluster_posed_centre_[c] - shapes.rest_centre()[c]) + shapes.centre()[c],
            (rotation * cluster_turn_[c]).normalized()};
    }
}

void SoftTissue::reset() {
    body_.reset();
}

}  // namespace eti::scene
