// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/tools/lip_retraction.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti {
namespace {

// Seen from the head: the glottis far below, gums 24 mm apart, lips 10 mm apart in front of them. Up in the
// picture is the patient's anterior, -y.
class LipRetractionTest : public ::testing::Test {
  protected:
    LipRetractionTest() {
        points_.fill(Vec3f::Zero());
        set(Landmark::glottis, {0.0f, 0.0f, 0.0f});
        set(Landmark::upper_gum, {0.0f, 0.008f, 0.060f});
        set(Landmark::lower_gum, {0.0f, -0.016f, 0.060f});
        set(Landmark::upper_lip, {0.0f, 0.003f, 0.068f});
        set(Landmark::lower_lip, {0.0f, -0.007f, 0.068f});
    }
    void set(Landmark which, const Vec3f& place) { points_[static_cast<std::size_t>(which)] = place; }

    Landmarks points_{};
    Vec3f eye_{0.0f, 0.0f, 0.36f};
};

TEST_F(LipRetractionTest, LipsClearTheGumsAndTissueBehindStays) {
    const LipRetraction lips = lip_retraction(eye_, points_);
    // The upper lip's edge moves 2 mm past the gum's crest, the lower one's level with the other gum.
    EXPECT_NEAR(lips.retract_lips(at(points_, Landmark::upper_lip)).y(), 0.010f, 1e-5f);
    EXPECT_NEAR(lips.retract_lips(at(points_, Landmark::lower_lip)).y(), -0.016f, 1e-5f);
    for (const float y : {-0.02f, -0.007f, 0.003f, 0.02f}) {
        const Vec3f behind(0.001f, y, 0.059f);
        EXPECT_EQ(lips.retract_lips(behind), behind);
    }
    EXPECT_FALSE(lips.moves({0.0f, 0.0f, 0.05f}, 0.009f));
    EXPECT_TRUE(lips.moves({0.0f, 0.0f, 0.05f}, 0.011f));
}

// Further out on the lip displacements decrease, and the order of points is kept.
TEST_F(LipRetractionTest, SkinCompressesWithoutFolding) {
    set(Landmark::upper_gum, {0.0f, 0.060f, 0.060f});  // as far as lips ever move
    set(Landmark::lower_gum, {0.0f, -0.060f, 0.060f});
    const LipRetraction lips = lip_retraction(eye_, points_);
    EXPECT_EQ(lips.upper_shift, LipRetraction::most);
    EXPECT_EQ(lips.lower_shift, LipRetraction::most);
    for (const float side : {1.0f, -1.0f}) {
        float before = -1.0f;
        for (int i = 0; i <= 80; ++i) {
            const Vec3f place(0.0f, side * (0.008f + 0.5e-3f * static_cast<float>(i)), 0.07f);
            const Vec3f held = lips.retract_lips(place);
            EXPECT_GT(side * held.y(), before);
            EXPECT_LE((held - place).norm(), lips.reach() + 1e-6f);
            before = side * held.y();
        }
        const Vec3f far(0.0f, side * 0.045f, 0.07f);
        EXPECT_LT((lips.retract_lips(far) - far).norm(), 1e-6f);
    }
}

// Between gum and lip, and from lip to lip at the corners, nothing jumps: over a tenth of a millimetre the
// displacement grows at most by the steepest step's slope, 1.5 of its height by its width.
TEST_F(LipRetractionTest, DisplacementIsContinuous) {
    set(Landmark::upper_gum, {0.0f, 0.012f, 0.060f});
    const LipRetraction lips = lip_retraction(eye_, points_);
    constexpr float apart = 0.1e-3f;
    const float along = 1.5f * lips.reach() / (LipRetraction::complete - LipRetraction::begins);
    const float across = 1.5f * (lips.upper_shift + lips.lower_shift) / 10e-3f;  // gap between the lips
    for (float y = -0.030f; y < 0.030f; y += apart) {
        for (float z = 0.058f; z < 0.070f; z += apart) {
            const Vec3f place(0.0f, y, z);
            const Vec3f held = lips.retract_lips(place);
            EXPECT_LT((lips.retract_lips(place + apart * Vec3f::UnitZ()) - held).norm(),
                      apart * std::hypot(1.0f, 1.05f * along));
            EXPECT_LT((lips.retract_lips(place + apart * Vec3f::UnitY()) - held).norm(),
                      apart * (1.05f + across));
        }
    }
}

// Fingers do not follow the eye: 10 mm of eye motion turn the displacement past the gum by less than a degree
// and a half.
TEST_F(LipRetractionTest, HardlyDependsOnEyePosition) {
    const LipRetraction lips = lip_retraction(eye_, points_);
    for (const Vec3f& by : {Vec3f(0.01f, 0.0f, 0.0f), Vec3f(0.0f, 0.01f, 0.0f), Vec3f(0.0f, 0.0f, 0.01f)}) {
        const LipRetraction moved = lip_retraction(eye_ + by, points_);
        EXPECT_NEAR(moved.upper_shift, lips.upper_shift, 0.5e-3f);
        EXPECT_NEAR(moved.lower_shift, lips.lower_shift, 0.5e-3f);
    }
}

TEST_F(LipRetractionTest, IsFiniteForAnyEyePosition) {
    for (const Vec3f& eye : {Vec3f(0.0f, 0.0f, 0.0f), Vec3f(0.0f, 0.3f, 0.0f), Vec3f(0.0f, 0.0f, -0.3f)}) {
        EXPECT_TRUE(lip_retraction(eye, points_).retract_lips({0.0f, 0.003f, 0.07f}).allFinite());
    }
    EXPECT_TRUE(lip_retraction(eye_, zero_landmarks()).retract_lips({0.0f, 0.003f, 0.07f}).allFinite());
}

}  // namespace
}  // namespace eti
