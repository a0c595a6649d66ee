// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/sizing_field.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {
namespace {

TEST(SizingField, IsFinestInCloseUpRegions) {
    const Newborn newborn{NewbornShape()};
    const SizingField detail(newborn, 1e-3f);
    const auto points = newborn.landmarks();
    EXPECT_NEAR(detail.edge(at(points, Landmark::glottis)), 0.2e-3f, 1e-5f);
    EXPECT_NEAR(detail.edge(at(points, Landmark::epiglottis_tip)), 0.3e-3f, 1e-5f);
    EXPECT_NEAR(detail.edge(at(points, Landmark::upper_lip)), 0.4e-3f, 1e-5f);
    EXPECT_NEAR(detail.edge(at(points, Landmark::lower_gum)), 0.4e-3f, 1e-5f);
    EXPECT_LE(detail.edge(at(points, Landmark::tongue_dorsum)), 1e-3f);
    EXPECT_GE(detail.edge(newborn.from_model({0, -18, 92})), 3e-3f) << "the scalp";
}

// Neighbouring cells differ by a factor of two at most: adaptive_isosurface.hpp requires less than 0.4.
TEST(SizingField, GradientIsAtMostOneQuarter) {
    const Newborn newborn{NewbornShape()};
    const SizingField detail(newborn, 1e-3f);
    const auto [low, high] = newborn.visible_bounds();
    Random random(7);
    const auto anywhere = [&] {
        return Vec3f(low +
                     (high - low).cwiseProduct(Vec3f(random.uniform(), random.uniform(), random.uniform())));
    };
    for (int i = 0; i < 2000; ++i) {
        const Vec3f a = anywhere(), b = a + 0.05f * (anywhere() - a);
        ASSERT_LE(std::fabs(detail.edge(a) - detail.edge(b)), 0.2501f * (a - b).norm() + 1e-7f);
        ASSERT_LE(std::fabs(detail.cloth_edge(a) - detail.cloth_edge(b)), 0.2501f * (a - b).norm() + 1e-7f);
    }
}

TEST(SizingField, ClothIsFinestAtHemAndFarEnd) {
    if (BodyShape::is_available()) {
        GTEST_SKIP() << "a whole body wears a nappy, of equal resolution everywhere";
    }
    const Newborn newborn{NewbornShape()};
    const SizingField detail(newborn, 1e-3f);
    const auto at_side = [&](float z) { return newborn.from_model({50, -18, z}); };
    EXPECT_NEAR(detail.cloth_edge(at_side(-84)), 1.4e-3f, 1e-5f);
    EXPECT_NEAR(detail.cloth_edge(at_side(-140)), 1.9e-3f, 1e-5f);
    EXPECT_GT(detail.cloth_edge(at_side(-110)), 3e-3f);
}

}  // namespace
}  // namespace eti::patient
