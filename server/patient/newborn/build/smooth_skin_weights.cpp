// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/smooth_skin_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "common/mesh/closest_point.hpp"
#include "common/mesh/point_grid.hpp"
#include "common/model/posture_range.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/mesh/adjacency.hpp"
#include "server/patient/mesh/normals.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

// Stretch limit of visible edges.
constexpr float smoothing_stretch_limit = 2.5f;
constexpr float accepted_stretch = 2.9f;     // the requirement is three
constexpr float min_visible_edge = 0.1e-3f;  // [m]
// Vertices within this many edges of a torn edge are smoothed, and one ring more after each number of rounds.
constexpr int smoothing_first_rings = 2;
constexpr int smoothing_rounds_per_ring = 8;
constexpr int lift_rounds = 50;
constexpr int posture_rounds = 40;  // after those of the lift, because raised heads are more frequent than
                                    // lifts
constexpr int smoothing_sweeps = 6;
// Half the weight of all neighbours together; with less, a vertex and its neighbours could swap values.
constexpr float self_weight = 0.5f;
// Both faces of a sheet thinner than this are smoothed together, or they would pass through each other.
constexpr float thin_sheet = 1.6e-3f;  // [m]
constexpr std::size_t max_across = 4;
constexpr float facing_away = -0.3f;  // cosine of the angle between their normals
// Minimum remaining fraction of a sheet's thickness.
constexpr float min_thickness = 0.4f;
// Smaller weights are dropped from means; otherwise each vertex would accumulate a little of every frame.
constexpr float least = 2e-3f;

// A lift as by the expert in a term newborn, in lengths of the plate: its tip moves anteriorly by the first,
// its root by the second, tissue around the valleculae by the third; beyond `lift_reach` there is hardly any
// motion.
constexpr float tip_travel = 1.0f;
constexpr float root_travel = 0.4f;
constexpr float tissue_travel = 0.3f;
constexpr float lift_reach = 1.4f;

// In lengths of the plate: points farther from its particles do not follow it (0.45 in check_model.cpp).
constexpr float plate_reach = 0.44f;
// In lengths of the plate: distance from the valleculae beyond which a lift does not tear.
constexpr float lifted_radius = 1.4f;
// Fraction of the distance from glottis to the epiglottis's tip below which weights are not smoothed.
constexpr float held_above = 0.08f;

// In lengths of the plate: distance from the line between glottis and tip within which weights are relaxed.
constexpr float relaxed_radius = 0.6f;
// A millimetre: the root of their number, times an edge of 0.3 mm and the weight of the neighbours.
constexpr int relaxing_sweeps = 24;
// Three millimetres, likewise; in lengths of the plate: distance from the valleculae within which the palate
// is soft.
constexpr int velum_sweeps = 140;
constexpr float velum_radius = 1.9f;

// [m], distances from an edge overstretched by smoothing: within the first, smoothing is undone, fading out
// to the second.
constexpr float restore_full_within = 1.5e-3f, restore_fade_within = 5e-3f;
constexpr int restore_rings = 30;

using Frames = std::vector<FrameMap>;

Frames frames_in_posture(const Patient& patient, const Posture& posture) {
    Frames maps;
    for (const FramePose& pose : posed_frames(patient, pose_bones(patient.skeleton, posture))) {
        maps.push_back(frame_map(pose, patient.frame_rest_centre[maps.size()]));
    }
    return maps;
}

struct Plate {
    Vec3f root, tip;
    [[nodiscard]] float length() const { return (tip - root).norm(); }
};

Plate plate_of(const Anatomy& anatomy) {
    const auto points = anatomy.landmarks();
    return {points[static_cast<std::size_t>(Landmark::epiglottis_base)],
            points[static_cast<std::size_t>(Landmark::epiglottis_tip)]};
}

Frames lifted(const Anatomy& anatomy, const Patient& patient) {
    const Vec3f vallecula = anatomy.landmarks()[static_cast<std::size_t>(Landmark::vallecula)];
    const Plate plate = plate_of(anatomy);
    const Vec3f along = (plate.tip - plate.root) / plate.length();
    const Vec3f front = -Vec3f::UnitY();
    FrameMap of_plate;
    of_plate.linear += (tip_travel - root_travel) * front * along.transpose();
    of_plate.offset =
        (root_travel * plate.length() - (tip_travel - root_travel) * along.dot(plate.root)) * front;
    Frames maps(patient.frame_rest_centre.size());
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        if (patient.clusters.tissue[c] == Tissue::epiglottis) {
            maps[bone_count + c] = of_plate;
            continue;
        }
        const float off = (patient.frame_rest_centre[bone_count + c] - vallecula).norm() / plate.length();
        maps[bone_count + c].offset =
            tissue_travel * std::exp(-off * off / (lift_reach * lift_reach)) * plate.length() * front;
    }
    return maps;
}

class SkinWeightSmoother {
  public:
    SkinWeightSmoother(const Anatomy& anatomy, const Patient& patient, const TriangleMesh& mesh,
                       std::span<const Tissue> tissues, std::span<Shares> carried)
        : mesh_(mesh), carried_(carried), around_(mesh), place_(carried.size()) {
        trials_[0] = lifted(anatomy, patient);
        std::size_t trial = 1;
        for (const float head : {0.0f, max_head_elevation}) {
            for (const float jaw : {0.0f, max_jaw_opening}) {
                trials_[trial++] = frames_in_posture(patient, {.head_elevation = head, .jaw_opening = jaw});
            }
        }
        frames_ = patient.frame_rest_centre.size();
        find_across();
        hold(anatomy);
        find_plate(anatomy, patient);
        const Vec3f vallecula = anatomy.landmarks()[static_cast<std::size_t>(Landmark::vallecula)];
        const float reach = velum_radius * plate_of(anatomy).length();
        for (std::uint32_t v = 0; v < held_.size(); ++v) {
            if (tissues[v] == Tissue::palate && (mesh.vertices[v] - vallecula).norm() < reach) {
                velum_.push_back(v);
            }
        }
    }

    /// Smooths all weights of the soft palate: the tongue on it leaves no room for particles in its lower
    /// part, which moves with the skull, while its root is released as the tongue is lifted.
    void relax_velum() {
        for (int sweep = 0; sweep < velum_sweeps; ++sweep) {
            take_mean_of_neighbours(velum_);
        }
    }

    /// Smooths all weights about larynx and plate: clusters a millimetre apart move differently in a lift,
    /// and a fold that a lens sees from 10 mm would wrinkle as they do.
    void relax(const Anatomy& anatomy) {
        const auto points = anatomy.landmarks();
        const Vec3f& glottis = points[static_cast<std::size_t>(Landmark::glottis)];
        const Plate plate = plate_of(anatomy);
        std::vector<std::uint32_t> which;
        for (std::uint32_t v = 0; v < held_.size(); ++v) {
            const float off = offset_from_segment(glottis, plate.tip, mesh_.vertices[v]).norm();
            if (held_[v] == 0 && off < relaxed_radius * plate.length()) {
                which.push_back(v);
            }
        }
        for (int sweep = 0; sweep < relaxing_sweeps; ++sweep) {
            take_mean_of_neighbours(which);
        }
    }

    void level() {
        std::vector<std::uint32_t> all(carried_.size());
        std::iota(all.begin(), all.end(), 0u);
        place(all);
        const std::vector<Shares> shares_before(carried_.begin(), carried_.end());
        const auto place_before = place_;
        level(0, lift_rounds);
        level(1, posture_rounds);
        restore_shares(shares_before, place_before);
    }

  private:
    // Smooths for the trials from `first_trial` on.
    void level(std::size_t first_trial, int rounds) {
        std::vector<std::uint8_t> levelled(carried_.size(), 0);
        for (int round = 0; round < rounds; ++round) {
            std::vector<std::uint8_t> torn = find_torn(first_trial);
            if (std::ranges::none_of(torn, [](std::uint8_t t) { return t != 0; })) {
                break;
            }
            for (int ring = 0; ring < smoothing_first_rings + round / smoothing_rounds_per_ring; ++ring) {
                torn = around_.dilated(torn);
            }
            for (std::size_t v = 0; v < torn.size(); ++v) {
                if (torn[v] == 1) {
                    for (const std::uint32_t b : across_[v]) {
                        torn[b] = std::max<std::uint8_t>(torn[b], 2);
                    }
                }
            }
            for (std::size_t v = 0; v < torn.size(); ++v) {
                if (torn[v] != 0) {
                    levelled[v] = 1;
                }
            }
            std::vector<std::uint32_t> which;
            for (std::uint32_t v = 0; v < levelled.size(); ++v) {
                if (levelled[v] != 0 && held_[v] == 0) {
                    which.push_back(v);
                }
            }
            for (int sweep = 0; sweep < smoothing_sweeps; ++sweep) {
                take_mean_of_neighbours(which);
            }
            place(which);
        }
    }

    static constexpr std::size_t trial_count = 5;
    using Places = std::vector<std::array<Vec3f, trial_count>>;  // [vertices][trials]

    // Next to fixed vertices, smoothing can steepen weights and overstretch edges in some postures; there the
    // weights before are restored.
    void restore_shares(const std::vector<Shares>& shares_before, const Places& place_before) {
        std::vector<float> off(carried_.size(), restore_fade_within);
        for (std::uint32_t a = 0; a < off.size(); ++a) {
            for (const std::uint32_t b : around_.of(a)) {
                const float length =
                    std::max((mesh_.vertices[a] - mesh_.vertices[b]).norm(), min_visible_edge);
                for (std::size_t k = 1; k < trial_count; ++k) {
                    const float now = (place_[a][k] - place_[b][k]).norm();
                    if (now > accepted_stretch * length &&
                        now > (place_before[a][k] - place_before[b][k]).norm()) {
                        off[a] = off[b] = 0.0f;
                    }
                }
            }
        }
        for (int ring = 0; ring < restore_rings; ++ring) {
            const std::vector<float> before = off;
            for (std::uint32_t v = 0; v < off.size(); ++v) {
                for (const std::uint32_t to : around_.of(v)) {
                    off[v] = std::min(off[v], before[to] + (mesh_.vertices[v] - mesh_.vertices[to]).norm());
                }
            }
        }
        for (std::size_t v = 0; v < off.size(); ++v) {
            const float back = 1.0f - smoothstep(restore_full_within, restore_fade_within, off[v]);
            if (back > 0.0f) {
                for (Share& share : carried_[v]) {
                    share.weight *= 1.0f - back;
                }
                for (const auto& [frame, weight] : shares_before[v]) {
                    add_share(carried_[v], frame, back * weight);
                }
            }
        }
    }

    // Fixes the glottis, so that it agrees with the contour used for the view, and everything below it; also
    // vertices far from the plate: at the corners of the mouth only bones cause tears, which
    // repair_skin_weights() handles.
    void hold(const Anatomy& anatomy) {
        const auto points = anatomy.landmarks();
        const Vec3f& glottis = points[static_cast<std::size_t>(Landmark::glottis)];
        const Vec3f vallecula = points[static_cast<std::size_t>(Landmark::vallecula)];
        const float plate = plate_of(anatomy).length();
        const Vec3f up = points[static_cast<std::size_t>(Landmark::epiglottis_tip)] - glottis;
        held_.assign(carried_.size(), 0);
        for (std::size_t v = 0; v < held_.size(); ++v) {
            const Vec3f off = mesh_.vertices[v] - glottis;
            const bool at_glottis = off.norm() < up.norm() && off.dot(up) < held_above * up.squaredNorm();
            held_[v] = at_glottis || (mesh_.vertices[v] - vallecula).norm() > lifted_radius * plate ? 1 : 0;
        }
    }

    // Frames of the epiglottis, and vertices near enough to follow them.
    void find_plate(const Anatomy& anatomy, const Patient& patient) {
        of_plate_.assign(frames_, 0);
        for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
            of_plate_[bone_count + c] = patient.clusters.tissue[c] == Tissue::epiglottis ? 1 : 0;
        }
        std::vector<Vec3f> plate;
        for (std::size_t i = 0; i < patient.particles.size(); ++i) {
            if (patient.particles.tissue[i] == Tissue::epiglottis) {
                plate.push_back(patient.particles.rest[i]);
            }
        }
        const float near = plate_reach * plate_of(anatomy).length();
        const PointGrid grid(plate, near);
        near_plate_.assign(carried_.size(), 0);
        parallel::for_each(carried_.size(), 256, [&](std::size_t v) {
            grid.within(mesh_.vertices[v], near, [&](std::uint32_t, float) { near_plate_[v] = 1; });
        });
    }

    void find_across() {
        const std::vector<Vec3f> normals = vertex_normals(mesh_);
        const PointGrid grid(mesh_.vertices, thin_sheet);
        across_.resize(carried_.size());
        parallel::for_each(carried_.size(), 256, [&](std::size_t a) {
            std::vector<std::pair<float, std::uint32_t>> found;
            grid.within(mesh_.vertices[a], thin_sheet, [&](std::uint32_t b, float squared) {
                const Vec3f way = mesh_.vertices[b] - mesh_.vertices[a];
                if (normals[a].dot(normals[b]) < facing_away && normals[a].dot(way) < 0.0f &&
                    normals[b].dot(way) > 0.0f) {
                    found.emplace_back(squared, b);
                }
            });
            std::ranges::sort(found);
            for (std::size_t k = 0; k < std::min(found.size(), max_across); ++k) {
                across_[a].push_back(found[k].second);
            }
        });
    }

    void place(const std::vector<std::uint32_t>& which) {
        parallel::for_each(which.size(), 256, [&](std::size_t i) {
            const std::uint32_t v = which[i];
            const SkinWeights skin = heaviest(carried_[v]);  // truncation must not cause tears, either
            for (std::size_t k = 0; k < trial_count; ++k) {
                place_[v][k] = skin_point(mesh_.vertices[v], skin, trials_[k]);
            }
        });
    }

    [[nodiscard]] std::vector<std::uint8_t> find_torn(std::size_t first_trial) const {
        std::vector<std::uint8_t> torn(carried_.size(), 0);
        parallel::for_each(carried_.size(), 256, [&](std::size_t a) {
            if (held_[a] != 0) {
                return;
            }
            for (const std::uint32_t b : around_.of(a)) {
                const float length =
                    std::max((mesh_.vertices[a] - mesh_.vertices[b]).norm(), min_visible_edge);
                for (std::size_t k = first_trial; k < trial_count; ++k) {
                    const float most = smoothing_stretch_limit * length;
                    if ((place_[a][k] - place_[b][k]).squaredNorm() > most * most) {
                        torn[a] = 1;
                    }
                }
            }
        });
        for (std::size_t a = 0; a < carried_.size(); ++a) {
            if (held_[a] != 0) {
                continue;
            }
            for (const std::uint32_t b : across_[a]) {
                const Vec3f through = mesh_.vertices[b] - mesh_.vertices[a];
                for (std::size_t k = first_trial; k < trial_count; ++k) {
                    if ((place_[b][k] - place_[a][k]).dot(through) < min_thickness * through.squaredNorm()) {
                        torn[a] = torn[b] = 1;
                    }
                }
            }
        }
        return torn;
    }

    // Computed for all before any is changed, so that results do not depend on order or threads.
    void take_mean_of_neighbours(const std::vector<std::uint32_t>& levelled) {
        means_.resize(levelled.size());
        parallel::for_ranges(levelled.size(), 64, [&](std::size_t begin, std::size_t end) {
            std::vector<float> sum(frames_, 0.0f);
            std::vector<std::uint16_t> used;
            for (std::size_t i = begin; i != end; ++i) {
                const std::uint32_t v = levelled[i];
                float whole = 0.0f;
                const auto add = [&](const Shares& shares, float pull) {
                    whole += pull;
                    for (const auto& [frame, weight] : shares) {
                        if (of_plate_[frame] > near_plate_[v]) {
                            continue;
                        }
                        if (sum[frame] == 0.0f) {
                            used.push_back(frame);
                        }
                        sum[frame] += pull * weight;
                    }
                };
                const auto pull_to = [&](std::uint32_t to) {
                    add(carried_[to],
                        1.0f / std::max((mesh_.vertices[v] - mesh_.vertices[to]).norm(), min_visible_edge));
                };
                std::ranges::for_each(around_.of(v), pull_to);
                std::ranges::for_each(across_[v], pull_to);
                add(carried_[v], self_weight * whole);
                Shares& mean = means_[i];
                mean.clear();
                float kept = 0.0f;
                for (const std::uint16_t f : used) {
                    if (sum[f] >= least * whole) {
                        mean.push_back({f, sum[f]});
                        kept += sum[f];
                    }
                    sum[f] = 0.0f;
                }
                used.clear();
                for (Share& share : mean) {
                    share.weight /= kept;
                }
            }
        });
        for (std::size_t i = 0; i < levelled.size(); ++i) {
            std::swap(carried_[levelled[i]], means_[i]);
        }
    }

    const TriangleMesh& mesh_;
    std::span<Shares> carried_;
    Adjacency around_;
    std::vector<std::vector<std::uint32_t>> across_;  // by vertex: vertices on the opposite face of a thin
                                                      // sheet
    std::array<Frames, trial_count> trials_;
    std::vector<std::uint8_t> held_;        // [vertices]
    std::vector<std::uint8_t> near_plate_;  // [vertices]
    std::vector<std::uint8_t> of_plate_;    // [frames]
    std::vector<std::uint32_t> velum_;      // vertices of the soft palate
    std::size_t frames_ = 0;
    std::vector<Shares> means_;
    Places place_;
};

}  // namespace

void smooth_skin_weights(const Anatomy& anatomy, const Patient& patient, const TriangleMesh& mesh,
                         std::span<const Tissue> tissues, std::span<Shares> carried) {
    SkinWeightSmoother smoother(anatomy, patient, mesh, tissues, carried);
    smoother.relax_velum();
    smoother.relax(anatomy);
    smoother.level();
}

}  // namespace eti::patient
