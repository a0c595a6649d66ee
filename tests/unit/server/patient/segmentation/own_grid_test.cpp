// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/grids/own_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/patient/imaging/resample.hpp"

namespace eti::segmentation {
namespace {

using imaging::Geometry;

Geometry grid(const Vec3d& origin) {
    Geometry g;
    g.size = {20, 20, 20};
    g.origin = origin;
    g.step = 2e-3 * Eigen::Matrix3d::Identity();
    return g;
}

/// Bone of 2.4 ml above z = 20 mm, partial volume linear across a voxel, soft tissue below.
imaging::Volume half_bone(const Geometry& g) {
    imaging::Volume ct{g, {}};
    for (std::size_t i = 0; i < g.count(); ++i) {
        const auto [x, y, z] = g.coordinates(i);
        const double share = std::clamp((g.point(x, y, z).z() - 20e-3) / 2e-3 + 0.5, 0.0, 1.0);
        ct.value.push_back(static_cast<float>(40.0 + 372.0 * share));  // half-way: 226 HU
    }
    return ct;
}

imaging::Mask by_threshold(const imaging::Volume& ct) {
    imaging::Mask labels{ct.geometry, {}};
    for (const float v : ct.value) {
        labels.value.push_back(value_of(v > SegmentSettings().bone_above ? Label::mandible : Label::soft));
    }
    return labels;
}

TEST(OwnGrid, GreyValueDecidesAtBorders) {
    // Between the voxels of the labels, where the nearest one is ambiguous.
    const imaging::Volume ct = half_bone(grid({0.9e-3, 0.9e-3, 0.9e-3}));
    const imaging::Mask labels = by_threshold(half_bone(grid(Vec3d::Zero())));
    ASSERT_NE(imaging::resample_labels(ct.geometry, labels).value, by_threshold(ct).value);
    EXPECT_EQ(labels_on_own_grid(ct, ct.geometry, labels, {}).value, by_threshold(ct).value);
}

TEST(OwnGrid, SameVoxelsKeepTheirLabels) {
    imaging::Volume ct = half_bone(grid(Vec3d::Zero()));
    const imaging::Mask labels = by_threshold(ct);
    std::ranges::fill(ct.value, -1000.0f);
    EXPECT_EQ(labels_on_own_grid(ct, ct.geometry, labels, {}).value, labels.value);
}

TEST(OwnGrid, SpecksOfBoneBesideABorderAreDropped) {
    imaging::Volume ct = half_bone(grid({1.1e-3, 1.1e-3, 1.1e-3}));
    const imaging::Mask labels = by_threshold(half_bone(grid(Vec3d::Zero())));
    // Noise takes a voxel off the bone, and adds the one below it.
    const std::size_t hole = ct.geometry.index(7, 7, 10);
    const std::size_t speck = ct.geometry.index(7, 7, 9);
    std::swap(ct.value[hole], ct.value[speck]);
    ASSERT_GT(ct.value[speck], SegmentSettings().bone_above);
    ASSERT_LT(ct.value[hole], SegmentSettings().bone_above);
    EXPECT_EQ(labels_on_own_grid(ct, ct.geometry, labels, {}).value[speck], value_of(Label::soft));
    SegmentSettings any;
    any.smallest_bone = 0.0f;
    EXPECT_EQ(labels_on_own_grid(ct, ct.geometry, labels, any).value[speck], value_of(Label::mandible));
}

}  // namespace
}  // namespace eti::segmentation
