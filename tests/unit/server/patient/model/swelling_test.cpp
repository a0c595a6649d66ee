// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/swelling.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "server/patient/model/stiffness.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {
namespace {

constexpr BuildSettings coarse{.spacing = 2.5e-3f, .fine_spacing = 2e-3f, .surface_spacing = 2.5e-3f};

Patient newborn(float tongue_scale, float stiffness = 8e3f) {
    BuildSettings settings = coarse;
    settings.tissue_stiffness = stiffness;
    // Surfaces and shell, nine tenths of a build, are not needed here: none are passed.
    const Patient bare;
    return build_patient(NewbornShape{.tongue_scale = tongue_scale}, settings, &bare);
}

const Patient& usual() {
    static const Patient patient = newborn(1.0f);
    return patient;
}

/// Six times the signed volume of a tetrahedron [m^3] with its corners moved by `growth` times the swelling.
double volume(const std::array<std::uint32_t, 4>& corners, const std::vector<Vec3f>& swelling, float growth) {
    Eigen::Matrix3d edges;
    const auto at = [&](std::size_t v) {
        const std::uint32_t i = corners[v];
        return (usual().particles.rest[i] + growth * swelling[i]).cast<double>().eval();
    };
    for (int v = 0; v < 3; ++v) {
        edges.col(v) = at(static_cast<std::size_t>(v) + 1) - at(0);
    }
    return edges.determinant();
}

bool of_tongue(const std::array<std::uint32_t, 4>& corners) {
    return std::ranges::all_of(corners,
                               [](std::uint32_t i) { return usual().particles.tissue[i] == Tissue::tongue; });
}

TEST(TongueSwelling, MovesOnlyFreeTongueParticles) {
    const std::vector<Vec3f> swelling = tongue_swelling(usual());
    const ParticleSet& set = usual().particles;
    ASSERT_EQ(swelling.size(), set.size());
    std::size_t moved = 0, held = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] != Tissue::tongue || set.mass[i] == 0.0f) {
            EXPECT_EQ(swelling[i], Vec3f(Vec3f::Zero())) << i;
            held += set.tissue[i] == Tissue::tongue ? 1 : 0;
        } else {
            moved += swelling[i].norm() > 0.0f ? 1 : 0;
        }
    }
    EXPECT_GT(moved, 500u);
    EXPECT_GT(held, 10u) << "where it grows from the mandible";
}

TEST(TongueSwelling, LeftMirrorsRight) {
    const std::vector<Vec3f> swelling = tongue_swelling(usual());
    const ParticleSet& set = usual().particles;
    double across = 0.0, most = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        across += static_cast<double>(swelling[i].x());
        most = std::max(most, static_cast<double>(swelling[i].norm()));
        if (set.rest[i].x() == 0.0f) {
            EXPECT_NEAR(swelling[i].x(), 0.0f, 2e-5f) << "the tolerance of the solution";
        }
    }
    EXPECT_NEAR(across / static_cast<double>(set.size()), 0.0, 1e-3 * most);
}

// A body that grows freely gains three times as much in volume as in length; one that is held on all sides
// but one (with nu = 0) as much. The tongue is held at bone and floor.
TEST(TongueSwelling, GrowsLessThanUnconstrainedBody) {
    const std::vector<Vec3f> swelling = tongue_swelling(usual());
    constexpr float growth = 0.01f;
    double before = 0.0, after = 0.0;
    for (const auto& corners : usual().tetrahedra.corners) {
        if (of_tongue(corners)) {
            before += std::fabs(volume(corners, swelling, 0.0f));
            after += std::fabs(volume(corners, swelling, growth));
        }
    }
    const double gain = (after / before - 1.0) / static_cast<double>(growth);
    EXPECT_LT(gain, 3.0 * 1.011) << "and (1 + g)^3";
    EXPECT_GT(gain, 1.0);
}

TEST(TongueSwelling, InvertsNoTetrahedron) {
    const std::vector<Vec3f> swelling = tongue_swelling(usual());
    for (const float growth : {min_growth - 1.0f, -0.2f, 0.4f, max_growth - 1.0f}) {
        double least = 1e9;
        for (const auto& corners : usual().tetrahedra.corners) {
            if (of_tongue(corners)) {
                least = std::min(least, volume(corners, swelling, growth) / volume(corners, swelling, 0.0f));
            }
        }
        EXPECT_GT(least, 0.05) << growth;
    }
}

/// Extent of the tongue along an axis: the mean of the fifty farthest particles there [m].
float reach(const Patient& patient, Eigen::Index axis, const std::vector<Vec3f>& swelling, float growth) {
    std::vector<float> far;
    for (std::size_t i = 0; i < patient.particles.size(); ++i) {
        if (patient.particles.tissue[i] == Tissue::tongue) {
            far.push_back(patient.particles.rest[i][axis] +
                          (swelling.empty() ? 0.0f : growth * swelling[i][axis]));
        }
    }
    std::ranges::sort(far, std::greater());
    return std::accumulate(far.begin(), far.begin() + 50, 0.0f) / 50.0f;
}

// Reference: the model built with that tongue. Both use lattices of 2.5 mm.
TEST(TongueSwelling, MatchesTongueBuiltLarger) {
    const std::vector<Vec3f> swelling = tongue_swelling(usual());
    const Patient large = newborn(1.2f);
    for (const Eigen::Index axis : {1, 2}) {  // backwards and up
        const float built = reach(large, axis, {}, 0.0f) - reach(usual(), axis, {}, 0.0f);
        const float grown = reach(usual(), axis, swelling, 0.2f) - reach(usual(), axis, {}, 0.0f);
        ASSERT_GT(built, 2e-3f) << axis;
        EXPECT_NEAR(grown, built, 0.5f * 2.5e-3f) << axis;
    }
}

TEST(Stiffness, SetLaterMatchesBuilt) {
    const Patient built = newborn(1.0f, 12e3f);
    Patient set = usual();
    set_tissue_stiffness(set, 12e3f);
    EXPECT_EQ(set.tissue_stiffness, built.tissue_stiffness);
    EXPECT_EQ(set.clusters.youngs_modulus, built.clusters.youngs_modulus);
    EXPECT_EQ(set.tetrahedra.youngs_modulus, built.tetrahedra.youngs_modulus);
    EXPECT_EQ(set.links.stiffness, built.links.stiffness);
    EXPECT_NE(set.links.stiffness, usual().links.stiffness);
    EXPECT_EQ(set.tetrahedra.corners, built.tetrahedra.corners);
    EXPECT_EQ(set.particles.rest, built.particles.rest);
}

}  // namespace
}  // namespace eti::patient
