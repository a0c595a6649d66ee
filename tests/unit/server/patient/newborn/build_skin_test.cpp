// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "common/math/units.hpp"
#include "common/mesh/check.hpp"
#include "common/model/posture_range.hpp"
#include "server/app/run/patient_cache.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/patient/newborn/build/skinner.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {
namespace {

// Requirement: an edge at most three times as long as at rest, for any posture of head and jaw. A newborn's
// mouth is about 28 mm wide and opens by as much at 35 deg. Its rim, at rest a slit of 56 mm, then is at
// least a circle of that diameter, 88 mm or 1.6 times as long. No skinning to bones can do better on average;
// three is that with the corners of the mouth stretched twice as much as the middle of the lips.
constexpr float max_stretch = 3.0f;
// The larynx is meshed at 0.3 mm, cords and epiglottis are more finely. Slivers among their triangles have
// edges down to 0.05 mm, which at three times the length are still shorter than the others.
constexpr float shortest_built_edge = 2e-4f;  // [m]

// Folds at the epiglottis follow it at one end and larynx or throat at the other, and weights of nine frames
// and more are truncated to eight there.
constexpr float most_at_folds = 3.1f;

struct Stretch {
    float most = 0.0f;  // relative to the limit there
    Vec3f where = Vec3f::Zero();
};

bool goes_with_plate(const Patient& patient, const SkinWeights& skin) {
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        const std::size_t frame = skin.frame[k];
        if (skin.weight[k] > 0.0f && frame >= bone_count && frame < bone_count + patient.clusters.size() &&
            patient.clusters.tissue[frame - bone_count] == Tissue::epiglottis) {
            return true;
        }
    }
    return false;
}

/// Vertices of the body that the tongue's root covers: nobody sees them.
std::vector<std::uint8_t> covered_by_tongue(const Newborn& newborn, const Surface& surface) {
    std::vector<std::uint8_t> covered(surface.mesh.vertices.size(), 0);
    for (std::size_t v = 0; surface.tissue == Tissue::soft && v < covered.size(); ++v) {
        covered[v] =
            newborn.visible_fields(surface.mesh.vertices[v]).tongue < -0.2e-3f * newborn.scale() / 1e-3f;
    }
    return covered;
}

Stretch stretch(const Patient& patient, const Surface& surface, const Posture& posture,
                const std::vector<std::uint8_t>& covered) {
    const std::vector<FramePose> frames = posed_frames(patient, pose_bones(patient.skeleton, posture));
    std::vector<Vec3f> now;
    for (std::size_t v = 0; v < surface.skin.size(); ++v) {
        now.push_back(
            skin_point(surface.mesh.vertices[v], surface.skin[v], patient.frame_rest_centre, frames));
    }
    std::vector<std::uint8_t> hung;
    for (const SkinWeights& skin : surface.skin) {
        hung.push_back(surface.tissue == Tissue::soft && goes_with_plate(patient, skin));
    }
    std::vector<std::uint8_t> larynx(surface.skin.size(), 0);
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
        for (const std::uint32_t v : surface.mesh.triangles[t]) {
            if (surface.triangle_tissue[t] == Tissue::larynx) {
                larynx[v] = 1;
            }
        }
    }
    Stretch found;
    for (const Triangle& t : surface.mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k];
            const std::uint32_t b = t[(k + 1) % 3];
            const float length = (surface.mesh.vertices[a] - surface.mesh.vertices[b]).norm();
            const bool fold = hung[a] || hung[b] || larynx[a] || larynx[b];
            const float ratio = length < shortest_built_edge ? 0.0f
                                                             : (now[a] - now[b]).norm() / length /
                                                                   (fold ? most_at_folds : max_stretch);
            if (ratio > found.most && !(covered[a] != 0 && covered[b] != 0)) {
                found = {ratio, surface.mesh.vertices[a]};
            }
        }
    }
    return found;
}

/// The newborns of the scenarios term and premature, from the cache if a server has built them.
class BuildSkin : public testing::TestWithParam<NewbornShape> {
  protected:
    static const Patient& patient() {
        static std::map<float, Patient> by_weight;
        const auto [it, is_new] = by_weight.try_emplace(GetParam().weight);
        if (is_new) {
            it->second = app::cached_patient(GetParam(), {});
        }
        return it->second;
    }
};

TEST_P(BuildSkin, NoPostureTearsSkin) {
    for (const Surface& surface : patient().surfaces) {
        if (is_bone(surface.tissue)) {
            continue;
        }
        const auto covered = covered_by_tongue(Newborn(GetParam()), surface);
        for (int head = 0; head <= 4; ++head) {
            for (int jaw = 0; jaw <= 5; ++jaw) {
                const Posture posture{.head_elevation = max_head_elevation * static_cast<float>(head) / 4,
                                      .jaw_opening = max_jaw_opening * static_cast<float>(jaw) / 5};
                const Stretch found = stretch(patient(), surface, posture, covered);
                EXPECT_LE(found.most, 1.0f) << surface.name << " at " << 1e3f * found.where.transpose()
                                            << " mm, head " << posture.head_elevation / degree << " deg, jaw "
                                            << posture.jaw_opening / degree << " deg";
            }
        }
    }
}

// Skinning moves vertices and adds no edges: what is closed at rest has no open edge in a lift.
TEST_P(BuildSkin, DrawnSurfacesAreClosedAndSimple) {
    for (const Surface& surface : patient().surfaces) {
        const MeshReport report = check(surface.mesh);
        EXPECT_TRUE(report.is_valid()) << surface.name << ": " << report.describe();
    }
}

TEST_P(BuildSkin, NeighbouringVerticesShareFrames) {
    // Overlap of neighbours' weights, summed: zero where no frame carries both, as for one edge in twenty of
    // soft tissue when each vertex followed its nearest particle.
    for (const Surface& surface : patient().surfaces) {
        if (is_bone(surface.tissue)) {
            continue;
        }
        std::size_t strangers = 0;
        for (const Triangle& t : surface.mesh.triangles) {
            const SkinWeights& a = surface.skin[t[0]];
            const SkinWeights& b = surface.skin[t[1]];
            float common = 0.0f;
            for (std::size_t i = 0; i < frames_per_point; ++i) {
                for (std::size_t k = 0; k < frames_per_point; ++k) {
                    if (a.frame[i] == b.frame[k]) {
                        common += std::min(a.weight[i], b.weight[k]);
                    }
                }
            }
            strangers += common < 0.1f ? 1 : 0;
        }
        EXPECT_LE(strangers, surface.mesh.triangles.size() / 1000) << surface.name;
    }
}

TEST_P(BuildSkin, BoneSurfacesFollowTheirBones) {
    for (const Surface& surface : patient().surfaces) {
        if (surface.tissue != Tissue::skull && surface.tissue != Tissue::mandible) {
            continue;
        }
        const auto bone =
            static_cast<std::uint16_t>(surface.tissue == Tissue::skull ? Bone::skull : Bone::mandible);
        const std::size_t grows = bone_count + patient().clusters.size();
        for (const SkinWeights& skin : surface.skin) {
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                EXPECT_TRUE(skin.weight[k] == 0.0f || skin.frame[k] == bone || skin.frame[k] >= grows);
            }
        }
    }
}

NewbornShape premature() {
    NewbornShape shape;
    shape.weight = 1.1f;
    shape.gestational_age = 28.0f;
    shape.tongue_scale = 1.15f;
    return shape;
}

INSTANTIATE_TEST_SUITE_P(Shapes, BuildSkin, testing::Values(NewbornShape(), premature()),
                         [](const auto& shape) { return shape.param.weight > 2.0f ? "term" : "premature"; });

TEST(HeaviestShares, WeightsChangeContinuouslyAsFramesDropOut) {
    // Ten frames, the last of which grows past the others: at the moment it is kept its weight is next to
    // zero.
    Shares shares;
    for (std::uint16_t f = 0; f < frames_per_point + 1; ++f) {
        shares.push_back({f, 0.1f + 0.01f * static_cast<float>(f)});
    }
    const auto weight_of = [](const SkinWeights& skin, std::uint16_t frame) {
        float sum = 0.0f;
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            sum += skin.frame[k] == frame ? skin.weight[k] : 0.0f;
        }
        return sum;
    };
    constexpr auto newcomer = static_cast<std::uint16_t>(frames_per_point + 1);
    shares.push_back({newcomer, 0.0f});
    SkinWeights before = heaviest(shares);
    bool kept = false;
    for (float weight = 0.0f; weight < 0.3f; weight += 1e-4f) {
        shares.back().weight = weight;
        const SkinWeights now = heaviest(shares);
        float sum = 0.0f;
        for (std::uint16_t f = 0; f <= newcomer; ++f) {
            // A ten-thousandth more of one changes no weight by more than the sum of the kept ones scales it,
            // a third here, and each of eight decreases by as much.
            EXPECT_NEAR(weight_of(now, f), weight_of(before, f), 1e-4f * 9 / 0.28f) << weight;
            sum += weight_of(now, f);
        }
        EXPECT_NEAR(sum, 1.0f, 1e-6f);
        kept = kept || weight_of(now, newcomer) > 0.1f;
        before = now;
    }
    EXPECT_TRUE(kept);
}

TEST(HeaviestShares, EqualSharesStillSumToOne) {
    Shares shares;
    for (std::uint16_t f = 0; f < 2 * frames_per_point; ++f) {
        shares.push_back({f, 1.0f / (2 * frames_per_point)});
    }
    float sum = 0.0f;
    for (const float weight : heaviest(shares).weight) {
        sum += weight;
    }
    EXPECT_NEAR(sum, 1.0f, 1e-6f);
}

}  // namespace
}  // namespace eti::patient
