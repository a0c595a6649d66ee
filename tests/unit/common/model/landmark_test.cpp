// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/landmark.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

Landmarks at_origin() {
    Landmarks points;
    points.fill(Vec3f::Zero());
    return points;
}

// The mid-sagittal plane of a newborn with the head raised and the mouth open.
Landmarks newborn() {
    Landmarks points = at_origin();
    const auto set = [&](Landmark which, float posterior, float superior) {
        points[static_cast<std::size_t>(which)] = Vec3f(0, posterior, superior);
    };
    set(Landmark::upper_gum, 0.014f, 0.022f);
    set(Landmark::lower_gum, -0.0004f, 0.0028f);
    set(Landmark::glottis, 0.040f, -0.031f);
    return points;
}

// Distance of a point from the line through a and b.
float off_line(const Vec3f& point, const Vec3f& a, const Vec3f& b) {
    return (point - a).cross((b - a).normalized()).norm();
}

TEST(Landmark, NamesAndOrderAgree) {
    for (std::size_t i = 0; i < landmark_count; ++i) {
        EXPECT_EQ(find_landmark(landmark_names[i]), static_cast<Landmark>(i));
    }
    EXPECT_FALSE(find_landmark("uvula"));
}

TEST(BestEye, LooksJustUnderTheUpperGum) {
    // 24 mm between the gums: the line passes a third of that, 8 mm, from the upper gum, less the cosine of
    // the angle between the gap and the line's normal. A lip held over the gum protrudes by as much.
    const Landmarks points = newborn();
    const Vec3f glottis = at(points, Landmark::glottis);
    const Vec3f gum = at(points, Landmark::upper_gum);
    const Vec3f gap = at(points, Landmark::lower_gum) - gum;
    ASSERT_NEAR(gap.norm(), 0.024f, 1e-6f);
    const float off = off_line(gum, glottis, best_eye(points));
    EXPECT_LE(off, 8e-3f + 1e-6f);
    EXPECT_GT(off, 6e-3f);
    EXPECT_LT(off_line(gum + gap / 3, glottis, best_eye(points)), 1e-6f);
}

TEST(BestEye, IsAtGivenDistanceBeyondTheGum) {
    const Landmarks points = newborn();
    const Vec3f glottis = at(points, Landmark::glottis);
    const float gum = (at(points, Landmark::upper_gum) - glottis).norm();
    // The line passes 8 mm beside the gum, so the distances differ by at most 8 mm.
    EXPECT_NEAR((best_eye(points, 0.3f) - glottis).norm(), gum + 0.3f, 8e-3f);
    EXPECT_NEAR((best_eye(points, 0.1f) - glottis).norm(), gum + 0.1f, 8e-3f);
}

// Landmarks of a patient that has not arrived coincide, and no direction leads from the glottis to the gum.
TEST(BestEye, IsAtTheGumWhileLandmarksCoincide) {
    Landmarks points;
    points.fill(Vec3f(0.1f, 0.2f, 0.3f));
    EXPECT_LT((best_eye(points) - Vec3f(0.1f, 0.2f, 0.3f)).norm(), 1e-6f);
}

}  // namespace
}  // namespace eti
