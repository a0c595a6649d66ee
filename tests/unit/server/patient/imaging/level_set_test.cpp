// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/level_set.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti::imaging {
namespace {

/// A cube of 41 nodes, 1 mm apart, with its middle at the origin.
DistanceGrid cube() {
    DistanceGrid grid;
    grid.spacing = 1e-3f;
    grid.size = {41, 41, 41};
    grid.origin = Vec3f::Constant(-20e-3f);
    grid.value.resize(41 * 41 * 41);
    return grid;
}

template <class Field>
std::vector<float> sampled(const DistanceGrid& grid, const Field& field) {
    std::vector<float> values;
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                values.push_back(field(grid.node(x, y, z)));
            }
        }
    }
    return values;
}

double volume_of(const DistanceGrid& grid) {
    double voxels = 0.0;
    for (const float v : grid.value) {
        // Linear across the border voxel, so that the volume is more accurate than a voxel.
        voxels += static_cast<double>(std::clamp(0.5f - v / grid.spacing, 0.0f, 1.0f));
    }
    return voxels * 1e-9;
}

TEST(LevelSet, SeedFillsRegionOfPositiveSpeed) {
    DistanceGrid grid = cube();
    grid.value = sampled(grid, [](const Vec3f& p) { return (p - Vec3f(4e-3f, 0, 0)).norm() - 3e-3f; });
    const auto speed =
        sampled(grid, [](const Vec3f& p) { return std::clamp((14e-3f - p.norm()) / 1e-3f, -1.0f, 1.0f); });
    const DistanceGrid front = evolve(grid, speed, {.curvature = 0.0f});
    const double expected = 4.0 / 3.0 * M_PI * std::pow(14e-3, 3);
    // A tenth of a voxel over the whole surface.
    EXPECT_NEAR(volume_of(front), expected, 4.0 * M_PI * 14e-3 * 14e-3 * 0.1e-3);
}

TEST(LevelSet, CurvatureFlowMatchesShrinkingBall) {
    // dr/dt = -2 b / r, so r^2 = r0^2 - 4 b t; a step lasts `step` voxels of time.
    DistanceGrid grid = cube();
    grid.value = sampled(grid, [](const Vec3f& p) { return p.norm() - 12e-3f; });
    const std::vector<float> still(grid.value.size(), 0.0f);
    constexpr float b = 0.5e-3f;
    constexpr int steps = 100;
    const float step = std::min(0.4f, 1.0f / (1.0f + 6.0f * b / grid.spacing));
    const DistanceGrid front = evolve(grid, still, {.curvature = b, .max_steps = steps, .rest = 0.0f});
    const double time = steps * static_cast<double>(step) * 1e-3;
    const double radius = std::sqrt(12e-3 * 12e-3 - 4.0 * 0.5e-3 * time);
    // Each of the 20 redistancing steps flattens the curvature by up to h^2 / (4 r)
    // (common/mesh/distance.hpp).
    EXPECT_NEAR(std::cbrt(volume_of(front) * 3.0 / 4.0 / M_PI), radius, 20.0 * 1e-6 / (4.0 * 11e-3));
    EXPECT_LT(radius, 10.5e-3) << "nothing to see";
}

TEST(LevelSet, StopsOnRequest) {
    DistanceGrid grid = cube();
    grid.value = sampled(grid, [](const Vec3f& p) { return p.norm() - 3e-3f; });
    const std::vector<float> outwards(grid.value.size(), 1.0f);
    int heard = 0;
    const DistanceGrid front = evolve(grid, outwards, {}, [&](int) { return ++heard < 2; });
    EXPECT_EQ(heard, 2);
    EXPECT_LT(volume_of(front), 4.0 / 3.0 * M_PI * std::pow(9e-3, 3));
}

}  // namespace
}  // namespace eti::imaging
