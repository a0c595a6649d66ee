// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/units.hpp"
#include "common/mesh/distance.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/point_grid.hpp"
#include "common/mesh/simplify.hpp"
#include "common/mesh/smooth.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/model/stiffness.hpp"
#include "server/patient/newborn/build.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/newborn/sample.hpp"

namespace eti::anatomy {

namespace {

// Takes the slivers of marching tetrahedra out, which would keep edges from collapsing.
constexpr int smoothing = 3;

constexpr float shell_band = 4e-3f;  // [m], within which the shell's distances are exact

/// Carries points by the clusters of the nearest particle of the same family, or by the bones where no
/// particle is near.
class Skinner {
  public:
    Skinner(const Anatomy& anatomy, const BuildSettings& settings, const Patient& patient)
        : anatomy_(anatomy), patient_(patient), clusters_of_(patient.particles.size()) {
        reach_ = 2.2f * settings.spacing * anatomy.scale() / millimetre;
        const ClusterSet& clusters = patient.clusters;
        for (std::uint32_t c = 0; c < clusters.size(); ++c) {
            for (std::uint32_t k = clusters.first[c]; k < clusters.first[c + 1]; ++k) {
                clusters_of_[clusters.member[k]].push_back(c);
            }
        }
        for (int family = 0; family < 3; ++family) {
            for (std::uint32_t i = 0; i < patient.particles.size(); ++i) {
                if (family_of(patient.particles.tissue[i]) == family) {
                    index_[family].push_back(i);
                    points_[family].push_back(patient.particles.rest[i]);
                }
            }
            grids_.emplace_back(points_[family], reach_);
        }
    }

    [[nodiscard]] SkinWeights operator()(const Vec3f& point, Tissue tissue) const {
        const int family = family_of(tissue);
        std::uint32_t nearest = 0;
        float nearest_squared = reach_ * reach_;
        bool found = false;
        grids_[static_cast<std::size_t>(family)].within(point, reach_, [&](std::uint32_t i, float squared) {
            if (squared < nearest_squared) {
                nearest = index_[family][i];
                nearest_squared = squared;
                found = true;
            }
        });
        if (!found || clusters_of_[nearest].empty() || goes_with_bone(tissue)) {
            return by_bones(point, tissue);
        }
        std::vector<std::pair<float, std::uint32_t>> near;
        for (const std::uint32_t c : clusters_of_[nearest]) {
            // The epiglottis moves with its own cluster alone: body clusters that hold its stalk would
            // drag the whole plate along (Xiao et al. 2020, Fig. 5).
            if (family_of(patient_.clusters.tissue[c]) == family) {
                near.emplace_back((patient_.frame_rest_centre[bone_count + c] - point).squaredNorm(), c);
            }
        }
        if (near.empty()) {
            return by_bones(point, tissue);
        }
        std::sort(near.begin(), near.end());
        SkinWeights skin;
        const float radius_squared = std::max(2.25f * reach_ * reach_, 1.1f * near.front().first);
        float total = 0.0f;
        for (std::size_t k = 0; k < std::min<std::size_t>(4, near.size()); ++k) {
            const float w = std::pow(std::max(1.0f - near[k].first / radius_squared, 0.0f), 2.0f);
            skin.frame[k] = static_cast<std::uint16_t>(bone_count + near[k].second);
            skin.weight[k] = w;
            total += w;
        }
        for (float& w : skin.weight) {
            w /= total;
        }
        return skin;
    }

  private:
    [[nodiscard]] static bool goes_with_bone(Tissue tissue) {
        return tissue == Tissue::skull || tissue == Tissue::mandible || tissue == Tissue::spine ||
               tissue == Tissue::upper_gum || tissue == Tissue::lower_gum;
    }
    [[nodiscard]] SkinWeights by_bones(const Vec3f& point, Tissue tissue) const {
        const BoneWeights weights = anatomy_.bone_weights(point, tissue);
        SkinWeights skin;
        for (std::size_t b = 0; b < bone_count; ++b) {
            skin.frame[b] = static_cast<std::uint16_t>(b);
            skin.weight[b] = weights[b];
        }
        return skin;
    }

    const Anatomy& anatomy_;
    const Patient& patient_;
    float reach_ = 0.0f;
    std::vector<std::vector<std::uint32_t>> clusters_of_;
    std::vector<std::uint32_t> index_[3];
    std::vector<Vec3f> points_[3];
    std::vector<PointGrid> grids_;
};

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

/// Gives what the skull alone carries its share of the frames by which the cranium grows.
void let_head_grow(const Anatomy& anatomy, Patient& patient) {
    constexpr auto skull = static_cast<std::uint16_t>(Bone::skull);
    struct Growing {
        SkinWeights& skin;
        std::array<float, head_frame_count> by;  // [m] per unit, to the left, right, back, front and up
    };
    std::vector<Growing> growing;
    float reach = 0.0f;  // [m], the longest way
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
        surface.skin.clear();
        for (const Vec3f& v : surface.mesh.vertices) {
            const bool soft = surface.tissue == Tissue::soft;
            surface.skin.push_back(skinner(v, soft ? anatomy.seen_tissue(v) : surface.tissue));
        }
    }
    hang_folds(anatomy, patient);
    let_head_grow(anatomy, patient);
}

void build_shell(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.airway_bounds();
    // The face belongs to it: a blade must not pass through lips and nose.
    const Vec3f room(10e-3f * size, 12e-3f * size, 8e-3f * size);
    DistanceGrid field = grid_over(low - room, high + room, 1.0e-3f * size);
    sample(anatomy, field, [&](std::size_t i, const Fields& f, const Vec3f& point) {
        field.value[i] = body_field(f, f.tongue, 0.0f) + anatomy.shell_offset(point, f);
    });
    TriangleMesh shell = isosurface(field, 0.0f);
    // Operators are tuned to this shell: a few crossings less than a millimetre deep are not worth another.
    smooth(shell, smoothing);
    patient.shell.mesh = simplify(shell, {.triangles = settings.shell_triangles, .importance = {}});
    patient.shell.distance =
        mesh_distance(patient.shell.mesh, field.origin, field.spacing, field.size, shell_band);
    for (const Triangle& t : patient.shell.mesh.triangles) {
        const auto& v = patient.shell.mesh.vertices;
        patient.shell.triangle_tissue.push_back(anatomy.lining((v[t[0]] + v[t[1]] + v[t[2]]) / 3.0f));
    }
    for (const Vec3f& v : patient.shell.mesh.vertices) {
        patient.shell.vertex_bones.push_back(anatomy.bone_weights(v, anatomy.lining(v)));
    }
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
        patient.landmarks[i] = {points[i], skinner(points[i], tissue)};
    }
    // Half-way between the jaws, however far they open.
    SkinWeights& mouth = patient.landmarks[static_cast<std::size_t>(Landmark::mouth_opening)].skin;
    mouth = {{static_cast<std::uint16_t>(Bone::skull), static_cast<std::uint16_t>(Bone::mandible)},
             {0.5f, 0.5f}};
    for (const Vec3f& p : anatomy.glottis_contour()) {
        patient.glottis_contour.push_back({p, skinner(p, Tissue::larynx)});
    }
}

Patient build_patient(const Anatomy& anatomy, const BuildSettings& settings, const Patient* formed) {
    Patient patient;
    patient.weight = anatomy.weight();
    patient.skeleton = anatomy.skeleton();
    build_particles(anatomy, settings, patient);
    build_clusters(anatomy, settings, patient);
    build_tetrahedra(anatomy, patient);
    build_links(anatomy, settings, patient);
    set_tissue_stiffness(patient, settings.tissue_stiffness);
    build_frames(patient);
    if (formed != nullptr) {
        patient.surfaces = formed->surfaces;
        patient.shell = formed->shell;
    } else {
        parallel::both([&] { build_surfaces(anatomy, settings, patient); },
                       [&] { build_shell(anatomy, settings, patient); });
    }
    skin_surfaces(anatomy, settings, patient);
    build_landmarks(anatomy, settings, patient);
    return patient;
}

Patient build_patient(const NewbornShape& shape, const BuildSettings& settings, const Patient* formed) {
    return build_patient(Newborn(shape), settings, formed);
}

}  // namespace eti::anatomy
