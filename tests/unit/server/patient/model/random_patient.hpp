// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <utility>

#include "common/math/random.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::patient::test {

inline Vec3f random_point(Random& random) {
    return {random.normal(), random.normal(), random.normal()};
}

inline SkinWeights random_skin(Random& random, std::size_t frames) {
    SkinWeights skin;
    float left = 1.0f;
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        skin.frame[k] = static_cast<std::uint16_t>(random.bits() % frames);
        skin.weight[k] = k + 1 == frames_per_point ? left : left * random.uniform();
        left -= skin.weight[k];
    }
    return skin;
}

inline BoneWeights random_bones(Random& random) {
    const float a = random.uniform();
    return {a, 1.0f - a, 0.0f};
}

inline Tissue random_tissue(Random& random) {
    return static_cast<Tissue>(random.bits() % tissue_count);
}

inline TriangleMesh random_mesh(Random& random, std::size_t vertices, std::size_t triangles) {
    TriangleMesh mesh;
    for (std::size_t i = 0; i < vertices; ++i) {
        mesh.vertices.push_back(random_point(random));
    }
    for (std::size_t i = 0; i < triangles; ++i) {
        mesh.triangles.push_back({static_cast<std::uint32_t>(random.bits() % vertices),
                                  static_cast<std::uint32_t>(random.bits() % vertices),
                                  static_cast<std::uint32_t>(random.bits() % vertices)});
    }
    return mesh;
}

/// A patient of random but valid numbers: every field must round-trip bit for bit.
inline Patient random_patient(std::size_t particles, std::size_t clusters, int grid) {
    Random random(7);
    Patient patient;
    patient.weight = 2.9f;
    patient.skeleton = {random_point(random), random_point(random), 0.012f};
    for (std::size_t i = 0; i < particles; ++i) {
        patient.particles.rest.push_back(random_point(random));
        patient.particles.mass.push_back(random.uniform());
        patient.particles.radius.push_back(random.uniform());
        patient.particles.tissue.push_back(random_tissue(random));
        patient.particles.bones.push_back(random_bones(random));
    }
    patient.clusters.first.push_back(0);
    for (std::size_t c = 0; c < clusters; ++c) {
        const std::size_t members = random.bits() % 30;
        for (std::size_t i = 0; i < members; ++i) {
            patient.clusters.member.push_back(static_cast<std::uint32_t>(random.bits() % particles));
        }
        patient.clusters.first.push_back(static_cast<std::uint32_t>(patient.clusters.member.size()));
        patient.clusters.youngs_modulus.push_back(8e3f + random.uniform());
        patient.clusters.tissue.push_back(random_tissue(random));
    }
    for (std::size_t i = 0; i < 13; ++i) {
        std::array<std::uint32_t, 4> corners{};
        for (std::uint32_t& corner : corners) {
            corner = static_cast<std::uint32_t>(random.bits() % particles);
        }
        patient.tetrahedra.corners.push_back(corners);
        patient.tetrahedra.youngs_modulus.push_back(1e3f + random.uniform());
    }
    for (std::size_t i = 0; i < 11; ++i) {
        patient.links.ends.push_back({static_cast<std::uint32_t>(random.bits() % particles),
                                      static_cast<std::uint32_t>(random.bits() % particles)});
        patient.links.stiffness.push_back(random.uniform());
    }
    const std::size_t frames = bone_count + clusters;
    for (std::size_t i = 0; i < frames + head_frame_count; ++i) {
        patient.frame_rest_centre.push_back(random_point(random));
    }
    for (const char* name : {"body", "tongue"}) {
        Surface surface;
        surface.name = name;
        surface.tissue = random_tissue(random);
        surface.mesh = random_mesh(random, particles / 2, particles);
        for (std::size_t i = 0; i < surface.mesh.triangles.size(); ++i) {
            surface.triangle_tissue.push_back(random_tissue(random));
        }
        for (std::size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
            surface.skin.push_back(random_skin(random, frames + head_frame_count));
        }
        patient.surfaces.push_back(std::move(surface));
    }
    patient.shell.mesh = random_mesh(random, particles / 2, particles);
    for (std::size_t i = 0; i < patient.shell.mesh.triangles.size(); ++i) {
        patient.shell.triangle_tissue.push_back(random_tissue(random));
    }
    for (std::size_t i = 0; i < patient.shell.mesh.vertices.size(); ++i) {
        patient.shell.vertex_bones.push_back(random_bones(random));
    }
    DistanceGrid& distance = patient.shell.distance;
    distance.origin = random_point(random);
    distance.spacing = 0.5e-3f;
    distance.size = {grid, grid + 1, grid + 2};
    for (int i = 0; i < grid * (grid + 1) * (grid + 2); ++i) {
        distance.value.push_back(random.normal());
    }
    for (CarriedPoint& landmark : patient.landmarks) {
        landmark = {random_point(random), random_skin(random, frames)};
    }
    for (int i = 0; i < 24; ++i) {
        patient.glottis_contour.push_back({random_point(random), random_skin(random, frames)});
    }
    return patient;
}

}  // namespace eti::patient::test
