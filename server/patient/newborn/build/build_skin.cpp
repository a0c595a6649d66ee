// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/patient/mesh/normals.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/build/repair_skin_weights.hpp"
#include "server/patient/newborn/build/skinner.hpp"
#include "server/patient/newborn/build/smooth_skin_weights.hpp"

namespace eti::patient {

namespace {

bool by_skull_alone(const SkinWeights& skin) {
    float weight = 0.0f;
    for (std::size_t k = 0; k < skin.frame.size(); ++k) {
        weight += skin.frame[k] == static_cast<std::uint16_t>(Bone::skull) ? skin.weight[k] : 0.0f;
    }
    return weight > 0.999f;
}

Vec3f cluster_centre(const Patient& patient, std::size_t c) {
    Vec3f sum = Vec3f::Zero();
    const ClusterSet& clusters = patient.clusters;
    for (std::uint32_t k = clusters.first[c]; k < clusters.first[c + 1]; ++k) {
        sum += patient.particles.rest[clusters.member[k]];
    }
    return sum / static_cast<float>(clusters.first[c + 1] - clusters.first[c]);
}

/// Adds the frames of the cranium's growth to the weights of points that only the skull carries.
void let_head_grow(const Anatomy& anatomy, Patient& patient) {
    constexpr auto skull = static_cast<std::uint16_t>(Bone::skull);
    struct Growing {
        SkinWeights& skin;
        std::array<float, head_frame_count> by;  // [m] per unit, to the left, right, back, front and up
    };
    std::vector<Growing> growing;
    float reach = 0.0f;  // [m], largest displacement
    for (Surface& surface : patient.surfaces) {
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            SkinWeights& skin = surface.skin[i];
            const Vec3f by = anatomy.head_growth(surface.mesh.vertices[i]);
            if (by_skull_alone(skin) && !by.isZero()) {
                growing.push_back({skin,
                                   {std::max(by.x(), 0.0f), std::max(-by.x(), 0.0f), std::max(by.y(), 0.0f),
                                    std::max(-by.y(), 0.0f), std::max(by.z(), 0.0f)}});
                reach = std::max(reach, by.lpNorm<1>());
            }
        }
    }
    const auto first = static_cast<std::uint16_t>(bone_count + patient.clusters.size());
    const std::array<Vec3f, head_frame_count> ways = {Vec3f::UnitX(), -Vec3f::UnitX(), Vec3f::UnitY(),
                                                      -Vec3f::UnitY(), Vec3f::UnitZ()};
    for (std::size_t k = 0; k < head_frame_count; ++k) {
        patient.frame_rest_centre[first + k] = reach * ways[k];
    }
    for (auto& [skin, by] : growing) {
        skin = {{skull}, {1.0f}};
        std::size_t next = 1;
        for (std::size_t k = 0; k < head_frame_count; ++k) {
            if (by[k] > 0.0f) {
                skin.frame[next] = static_cast<std::uint16_t>(first + k);
                skin.weight[next] = by[k] / reach;
                skin.weight[0] -= skin.weight[next];
                ++next;
            }
        }
        skin.weight[0] = std::max(skin.weight[0], 0.0f);
    }
}

/// Couples a fold between the epiglottis and larynx, tongue or pharyngeal wall to the nearest part of the
/// plate, from which it would otherwise tear when the plate is lifted.
void couple_to_plate(Shares& shares, const Shares& plate, float share) {
    for (Share& other : shares) {
        other.weight *= 1.0f - share;
    }
    for (const auto& [frame, weight] : plate) {
        add_share(shares, frame, share * weight);
    }
}

/// Coupling of each vertex to the epiglottis, smoothed along the surface: as a function of position alone it
/// changes within a millimetre, which would overstretch edges when the head is raised.
std::vector<float> epiglottis_couplings(const Anatomy& anatomy, const TriangleMesh& mesh) {
    constexpr int rounds = 12;
    std::vector<float> share(mesh.vertices.size());
    std::ranges::transform(mesh.vertices, share.begin(),
                           [&](const Vec3f& p) { return anatomy.epiglottis_coupling(p); });
    const std::vector<float> of_place = share;
    for (int round = 0; round < rounds; ++round) {
        std::vector<float> sum = share;
        std::vector<float> count(share.size(), 1.0f);
        for (const Triangle& t : mesh.triangles) {
            if (share[t[0]] + share[t[1]] + share[t[2]] <= 0.0f) {
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) {
                sum[t[k]] += share[t[(k + 1) % 3]] + share[t[(k + 2) % 3]];
                count[t[k]] += 2.0f;
            }
        }
        for (std::size_t i = 0; i < share.size(); ++i) {
            share[i] = of_place[i] > 0.0f ? sum[i] / count[i] : 0.0f;  // distant vertices are unchanged
        }
    }
    return share;
}

}  // namespace

void build_frames(Patient& patient) {
    patient.frame_rest_centre.assign(bone_count, Vec3f::Zero());
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        patient.frame_rest_centre.push_back(cluster_centre(patient, c));
    }
    patient.frame_rest_centre.resize(patient.frame_rest_centre.size() + head_frame_count, Vec3f::Zero());
}

void skin_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const Skinner skinner(anatomy, settings, patient);
    for (Surface& surface : patient.surfaces) {
        const std::vector<Vec3f>& vertices = surface.mesh.vertices;
        const std::vector<Vec3f> normals = vertex_normals(surface.mesh);
        std::vector<Shares> carried(vertices.size());
        std::vector<Tissue> tissues(vertices.size(), surface.tissue);
        parallel::for_each(vertices.size(), 256, [&](std::size_t i) {
            if (surface.tissue == Tissue::soft) {
                tissues[i] = anatomy.visible_tissue(vertices[i]);
            }
            carried[i] = skinner(vertices[i], tissues[i], normals[i]);
        });
        if (surface.tissue == Tissue::soft || surface.tissue == Tissue::tongue) {
            repair_skin_weights(patient, surface.mesh, carried);
        }
        if (surface.tissue == Tissue::soft) {
            const std::vector<float> share = epiglottis_couplings(anatomy, surface.mesh);
            for (std::size_t i = 0; i < vertices.size(); ++i) {
                if (share[i] > 0.0f) {
                    couple_to_plate(carried[i], skinner(vertices[i], Tissue::epiglottis), share[i]);
                }
            }
        }
        if (surface.tissue == Tissue::soft || surface.tissue == Tissue::tongue) {
            smooth_skin_weights(anatomy, patient, surface.mesh, tissues, carried);
        }
        surface.skin.resize(vertices.size());
        std::ranges::transform(carried, surface.skin.begin(), heaviest);
    }
    let_head_grow(anatomy, patient);
}

void build_landmarks(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const Skinner skinner(anatomy, settings, patient);
    const auto points = anatomy.landmarks();
    for (std::size_t i = 0; i < landmark_count; ++i) {
        Tissue tissue = Tissue::soft;
        switch (static_cast<Landmark>(i)) {
            case Landmark::upper_gum:
                tissue = Tissue::upper_gum;
                break;
            case Landmark::lower_gum:
                tissue = Tissue::lower_gum;
                break;
            case Landmark::tongue_tip:
            case Landmark::tongue_dorsum:
            case Landmark::vallecula:
                tissue = Tissue::tongue;
                break;
            case Landmark::epiglottis_tip:
                tissue = Tissue::epiglottis;
                break;
            default:
                break;
        }
        patient.landmarks[i] = {points[i], heaviest(skinner(points[i], tissue))};
    }
    // Half-way between the jaws at any opening.
    SkinWeights& mouth = patient.landmarks[static_cast<std::size_t>(Landmark::mouth_opening)].skin;
    mouth = {{static_cast<std::uint16_t>(Bone::skull), static_cast<std::uint16_t>(Bone::mandible)},
             {0.5f, 0.5f}};
    for (const Vec3f& p : anatomy.glottis_contour()) {
        patient.glottis_contour.push_back({p, heaviest(skinner(p, Tissue::larynx))});
    }
}

}  // namespace eti::patient
