// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/smooth_grid.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace eti::fem {
namespace {

/// A ball of 10 mm about 0, on nodes 1 mm apart.
DistanceGrid ball() {
    DistanceGrid grid{Vec3f::Constant(-15e-3f), 1e-3f, {31, 31, 31}, {}};
    for (int z = 0; z < 31; ++z) {
        for (int y = 0; y < 31; ++y) {
            for (int x = 0; x < 31; ++x) {
                grid.value.push_back(grid.node(x, y, z).norm() - 10e-3f);
            }
        }
    }
    return grid;
}

TEST(SmoothGrid, PassesThroughItsNodes) {
    const DistanceGrid grid = ball();
    const SmoothGrid smooth(grid);
    for (const auto& [x, y, z] : {std::array{3, 4, 5}, std::array{0, 0, 0}, std::array{30, 30, 30}}) {
        EXPECT_NEAR(smooth.sample(grid.node(x, y, z).cast<double>()).distance,
                    static_cast<double>(grid.value[grid.index(x, y, z)]), 1e-9);
    }
}

TEST(SmoothGrid, MatchesBallDistanceAndSlope) {
    // Cubics leave an error of third order in spacing over radius, here 1e-3 of the spacing; single precision
    // leaves 1e-9 m.
    const SmoothGrid smooth(ball());
    for (int k = 0; k < 50; ++k) {
        const Vec3d out = Vec3d(std::sin(1.0 * k), std::cos(2.3 * k), std::sin(0.7 * k + 1.0)).normalized();
        const Solid::Sample sample = smooth.sample((9.5e-3 + 2e-5 * k) * out);
        EXPECT_NEAR(sample.distance, -0.5e-3 + 2e-5 * k, 1e-6);
        EXPECT_LT((sample.slope - out).norm(), 0.01);
    }
}

TEST(SmoothGrid, DerivativesMatchFiniteDifferences) {
    // Steps of 1e-7 m within a cell: rounding 1e-16 * 1e-2 / 1e-7 and truncation 1e-14 over squares of 1e-3.
    const SmoothGrid smooth(ball());
    const Vec3d at(4.3e-3, -6.2e-3, 5.1e-3);
    const Solid::Sample sample = smooth.sample(at);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Vec3d way = 1e-7 * Vec3d::Unit(axis);
        const Solid::Sample up = smooth.sample(at + way);
        const Solid::Sample down = smooth.sample(at - way);
        EXPECT_NEAR((up.distance - down.distance) / 2e-7, sample.slope[axis], 1e-7);
        EXPECT_LT(((up.slope - down.slope) / 2e-7 - sample.bend.col(axis)).norm(), 1e-4 * sample.bend.norm());
    }
}

}  // namespace
}  // namespace eti::fem
