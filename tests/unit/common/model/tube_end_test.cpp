// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/tube_end.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace eti {
namespace {

constexpr float radius = 2e-3f;  // [m]

TEST(TubeEnd, StartsBehindTheBevel) {
    // Down the patient, nearly straight: its concave side is anterior (-y), its left the patient's left (+x).
    std::vector<Vec3f> nodes;
    for (int i = 0; i <= 40; ++i) {
        nodes.emplace_back(0.0f, 0.0f, -4e-3f * static_cast<float>(i));
    }
    const std::optional<TubeEnd> end = tube_end(nodes, radius);
    ASSERT_TRUE(end);
    EXPECT_EQ(end->tip, nodes.back());
    EXPECT_NEAR((end->start - Vec3f(0, 0, -0.154f)).norm(), 0.0f, 1e-6f) << "three radii before the tip";
    EXPECT_EQ(end->nodes, 39u);
    const auto cut_off = [&](const Vec3f& from_tip) { return from_tip.dot(end->bevel) > end->beyond; };
    // 45 deg: the right wall reaches the tip, the left one ends a diameter before it.
    EXPECT_FALSE(cut_off({-radius, 0, 0.05e-3f}));
    EXPECT_TRUE(cut_off({-radius, 0, -0.05e-3f}));
    EXPECT_FALSE(cut_off({radius, 0, 2 * radius + 0.05e-3f}));
    EXPECT_TRUE(cut_off({radius, 0, 2 * radius - 0.05e-3f}));
    EXPECT_FALSE(cut_off({0, radius, radius + 0.05e-3f}));
    EXPECT_TRUE(cut_off({0, -radius, radius - 0.05e-3f}));
}

TEST(TubeEnd, SpansWholeShortTube) {
    const std::vector<Vec3f> nodes{{0, 0, 0}, {0, 0, -1e-3f}, {0, 0, -2e-3f}};
    const std::optional<TubeEnd> end = tube_end(nodes, radius);
    ASSERT_TRUE(end);
    EXPECT_EQ(end->start, nodes.front());
    EXPECT_EQ(end->nodes, 0u);
}

TEST(TubeEnd, IsEmptyWithoutATube) {
    EXPECT_FALSE(tube_end({}, radius));
    EXPECT_FALSE(tube_end(std::vector<Vec3f>{{0, 0, 1}}, radius));
    EXPECT_FALSE(tube_end(std::vector<Vec3f>(5, Vec3f(0, 0, 1)), radius));
}

}  // namespace
}  // namespace eti
