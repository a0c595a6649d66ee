// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/resample.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti::imaging {
namespace {

/// A grey value that is linear in space, which interpolation must reproduce.
float ramp(const Vec3d& p) {
    return static_cast<float>(1000.0 * p.x() - 500.0 * p.y() + 250.0 * p.z());
}

Volume ramp_on(const Eigen::Matrix3d& step) {
    Volume volume;
    volume.geometry.size = {24, 20, 16};
    volume.geometry.origin = Vec3d(0.01, 0.02, -0.03);
    volume.geometry.step = step;
    for (std::size_t i = 0; i < volume.geometry.count(); ++i) {
        const auto [x, y, z] = volume.geometry.coordinates(i);
        volume.value.push_back(ramp(volume.geometry.point(x, y, z)));
    }
    return volume;
}

/// Voxels of the upright volume whose neighbourhood lies in the original must have the ramp's value.
void expect_ramp(const Volume& turned, const Geometry& original, double tolerance) {
    std::size_t compared = 0;
    for (std::size_t i = 0; i < turned.value.size(); ++i) {
        const auto [x, y, z] = turned.geometry.coordinates(i);
        const Vec3d point = turned.geometry.point(x, y, z);
        const Vec3d at = original.to_index(point);
        bool inner = true;
        for (int k = 0; k < 3; ++k) {
            inner = inner && at[k] > 0.0 && at[k] < original.size[static_cast<std::size_t>(k)] - 1;
        }
        if (inner) {
            ++compared;
            ASSERT_NEAR(turned.value[i], ramp(point), tolerance);
        }
    }
    EXPECT_GT(compared, turned.value.size() / 10);
}

TEST(UprightResampling, UprightVolumeIsUnchanged) {
    const Volume volume = ramp_on(1e-3 * Eigen::Matrix3d::Identity());
    const Volume same = resample_upright(volume);
    EXPECT_EQ(same.value, volume.value);
    EXPECT_EQ(same.geometry.size, volume.geometry.size);
}

TEST(UprightResampling, PermutedAxesKeepTheirValues) {
    Eigen::Matrix3d step;
    step << 0, 0, -1e-3, 1e-3, 0, 0, 0, -1e-3, 0;
    const Volume volume = ramp_on(step);
    const Volume turned = resample_upright(volume);
    EXPECT_EQ(turned.geometry.size, (std::array<int, 3>{16, 24, 20}));
    expect_ramp(turned, volume.geometry, 1e-3);
    EXPECT_EQ(*std::min_element(turned.value.begin(), turned.value.end()),
              *std::min_element(volume.value.begin(), volume.value.end()));
}

TEST(UprightResampling, ObliqueOrShearedVolumeIsInterpolated) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vec3d(1, 1, 0).normalized()).toRotationMatrix();
    Eigen::Matrix3d sheared = Vec3d(1e-3, 1e-3, 2e-3).asDiagonal();
    sheared(1, 2) = 0.5e-3;  // a tilted gantry
    for (const Eigen::Matrix3d& step : {Eigen::Matrix3d(turn * Vec3d(1e-3, 1e-3, 1e-3).asDiagonal()),
                                        Eigen::Matrix3d(Vec3d(0.5e-3, 0.5e-3, 2e-3).asDiagonal()), sheared}) {
        const Volume volume = ramp_on(step);
        const Volume turned = resample_upright(volume);
        EXPECT_NEAR(turned.geometry.spacing().maxCoeff(), volume.geometry.spacing().minCoeff(), 1e-12);
        expect_ramp(turned, volume.geometry, 1e-3);
    }
}

TEST(UprightResampling, LargeResultGetsLargerVoxels) {
    const Volume volume = ramp_on(Vec3d(0.1e-3, 1e-3, 1e-3).asDiagonal());
    // One more voxel than spacings along each axis.
    EXPECT_LE(resample_upright(volume, 5000).value.size(), 7500u);
}

TEST(UprightResampling, LabelsMapBackToOriginalGrid) {
    Eigen::Matrix3d step;
    step << 0, 0, -1e-3, 1e-3, 0, 0, 0, -1e-3, 0;
    const Volume volume = ramp_on(step);
    const Volume turned = resample_upright(volume);
    Mask labels{turned.geometry, {}};
    for (const float v : turned.value) {
        labels.value.push_back(v > 0.0f ? 3 : 1);
    }
    const Mask back = resample_labels(volume.geometry, labels);
    for (std::size_t i = 0; i < back.value.size(); ++i) {
        if (std::fabs(volume.value[i]) > 1e-3f) {
            ASSERT_EQ(back.value[i], volume.value[i] > 0.0f ? 3 : 1);
        }
    }
}

}  // namespace
}  // namespace eti::imaging
