// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/repair_skin_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/model/posture_range.hpp"
#include "server/patient/mesh/adjacency.hpp"
#include "server/patient/model/skeleton.hpp"

namespace eti::patient {

namespace {

// Stretch limit. The requirement is three (tests/unit/server/patient/newborn/build_skin_test.cpp); the margin
// is for postures between those tested, and for truncation to few frames.
constexpr float repair_stretch_limit = 2.5f;
// Vertices within this many edges of a torn edge are smoothed, and one ring more after each number of rounds.
constexpr int repair_first_rings = 2;
constexpr int repair_rounds_per_ring = 10;
constexpr int max_rounds = 100;
constexpr int repair_sweeps = 4;
constexpr float over_relaxation = 1.4f;
// Factor by which an edge that is still torn pulls its ends together harder. At the corner of the mouth,
// where a slit ends, smoothing alone leaves a tear, as at the tip of any crack.
constexpr float harder = 1.3f;
constexpr float fade = 5e-3f;   // [m], along the surface, over which particles take over again
constexpr int fade_rings = 40;  // in numbers of the shortest edges; an abrupt end would tear skin

struct RepairEdge {
    float length;  // [m]
    float pull;
};

class SkinWeightRepair {
  public:
    SkinWeightRepair(const Patient& patient, const TriangleMesh& mesh, std::span<Shares> carried)
        : mesh_(mesh), carried_(carried), around_(mesh), bones_(mesh.vertices.size()) {
        for (const float head : {0.0f, max_head_elevation}) {
            for (const float jaw : {0.0f, max_jaw_opening}) {
                postures_.push_back(
                    pose_bones(patient.skeleton, {.head_elevation = head, .jaw_opening = jaw}));
            }
        }
        for (std::uint32_t a = 0; a < mesh.vertices.size(); ++a) {
            for (const std::uint32_t b : around_.of(a)) {
                const float length = (mesh.vertices[a] - mesh.vertices[b]).norm();
                edges_.push_back({length, 1.0f / std::max(length, 1e-4f)});
            }
        }
        const std::vector<BoneWeights> of_frame = frame_bones(patient);
        for (std::size_t v = 0; v < carried.size(); ++v) {
            bones_[v] = {};
            for (const auto& [frame, weight] : carried[v]) {
                for (std::size_t b = 0; b < bone_count; ++b) {
                    bones_[v][b] += weight * of_frame[frame][b];
                }
            }
        }
        levelled_.assign(carried.size(), 0);
        place_.resize(carried.size());
    }

    void run() {
        pose(false);
        for (int round = 0; round < max_rounds; ++round) {
            std::vector<std::uint8_t> torn = find_torn();
            if (std::ranges::none_of(torn, [](std::uint8_t t) { return t != 0; })) {
                break;
            }
            for (int ring = 0; ring < repair_first_rings + round / repair_rounds_per_ring; ++ring) {
                torn = around_.dilated(torn);
            }
            for (std::size_t v = 0; v < torn.size(); ++v) {
                levelled_[v] |= torn[v];
            }
            for (int sweep = 0; sweep < repair_sweeps; ++sweep) {
                level(sweep % 2 != 0);
            }
            pose(true);
        }
        hand_over();
    }

  private:
    void pose(bool levelled_alone) {
        for (std::size_t v = 0; v < place_.size(); ++v) {
            if (levelled_[v] != 0 || !levelled_alone) {
                for (std::size_t p = 0; p < postures_.size(); ++p) {
                    place_[v][p] = pose_point(mesh_.vertices[v], bones_[v], postures_[p]);
                }
            }
        }
    }

    // Increases the pull of the torn edges.
    std::vector<std::uint8_t> find_torn() {
        std::vector<std::uint8_t> torn(place_.size(), 0);
        for (std::uint32_t a = 0; a < place_.size(); ++a) {
            each_edge(a, [&](std::uint32_t to, RepairEdge& edge) {
                const float most = repair_stretch_limit * edge.length;
                for (std::size_t p = 0; p < postures_.size(); ++p) {
                    if ((place_[a][p] - place_[to][p]).squaredNorm() > most * most) {
                        torn[a] = torn[to] = 1;
                        edge.pull *= harder;
                        break;
                    }
                }
            });
        }
        return torn;
    }

    template <typename Visit>
    void each_edge(std::size_t from, Visit&& visit) {
        const auto to = around_.of(from);
        for (std::size_t k = 0; k < to.size(); ++k) {
            visit(to[k], edges_[around_.first(from) + k]);
        }
    }

    // Gauss-Seidel iteration towards the mean of the neighbours.
    void level(bool backwards) {
        for (std::size_t n = 0; n < bones_.size(); ++n) {
            const std::size_t v = backwards ? bones_.size() - 1 - n : n;
            if (levelled_[v] == 0) {
                continue;
            }
            BoneWeights mean{};
            float pull = 0.0f;
            each_edge(v, [&](std::uint32_t to, const RepairEdge& edge) {
                pull += edge.pull;
                for (std::size_t b = 0; b < bone_count; ++b) {
                    mean[b] += edge.pull * bones_[to][b];
                }
            });
            float total = 0.0f;
            for (std::size_t b = 0; b < bone_count; ++b) {
                const float now = bones_[v][b];
                mean[b] = std::max(now + over_relaxation * (mean[b] / pull - now), 0.0f);
                total += mean[b];
            }
            for (std::size_t b = 0; b < bone_count; ++b) {
                bones_[v][b] = mean[b] / total;
            }
        }
    }

    void hand_over() {
        std::vector<float> by_bones(levelled_.begin(), levelled_.end());
        for (int ring = 0; ring < fade_rings; ++ring) {
            const std::vector<float> before = by_bones;
            for (std::size_t v = 0; v < before.size(); ++v) {
                each_edge(v, [&](std::uint32_t to, const RepairEdge& edge) {
                    by_bones[v] = std::max(by_bones[v], before[to] - edge.length / fade);
                });
            }
        }
        for (std::size_t v = 0; v < carried_.size(); ++v) {
            const float s = by_bones[v] * by_bones[v] * (3.0f - 2.0f * by_bones[v]);
            if (s <= 0.0f) {
                continue;
            }
            for (Share& share : carried_[v]) {
                share.weight *= 1.0f - s;
            }
            std::erase_if(carried_[v], [](const Share& share) { return share.weight <= 0.0f; });
            for (std::size_t b = 0; b < bone_count; ++b) {
                add_share(carried_[v], b, s * bones_[v][b]);
            }
        }
    }

    const TriangleMesh& mesh_;
    std::span<Shares> carried_;
    std::vector<BonePoses> postures_;
    Adjacency around_;
    std::vector<RepairEdge> edges_;            // in the order of the adjacency
    std::vector<BoneWeights> bones_;           // weights of each vertex, with clusters replaced by their
                                               // bones
    std::vector<std::uint8_t> levelled_;       // [vertices]
    std::vector<std::array<Vec3f, 4>> place_;  // [vertices][postures]
};

}  // namespace

void repair_skin_weights(const Patient& patient, const TriangleMesh& mesh, std::span<Shares> carried) {
    SkinWeightRepair(patient, mesh, carried).run();
}

}  // namespace eti::patient
