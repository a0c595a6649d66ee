// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/newborn.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "common/math/units.hpp"

namespace eti::patient {
namespace {

Vec3f place_of(const Newborn& newborn, Landmark which) {
    return newborn.landmarks()[static_cast<std::size_t>(which)];
}

NewbornShape shape_with(float NewbornShape::*field, float value) {
    NewbornShape shape;
    shape.*field = value;
    return shape;
}

/// Calls visit(point) throughout the airway.
template <class Visit>
void for_airway(const Newborn& newborn, const Visit& visit) {
    Random random(3);
    const auto [low, high] = newborn.airway_bounds();
    for (int k = 0; k < 4000; ++k) {
        visit(low + Vec3f(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(high - low));
    }
}

TEST(Newborn, LargerCraniumKeepsAirway) {
    const Newborn usual{NewbornShape()};
    const Newborn large(shape_with(&NewbornShape::head_scale, 1.15f));
    for_airway(usual, [&](const Vec3f& point) {
        const Fields a = usual.fields(point);
        const Fields b = large.fields(point);
        EXPECT_EQ(a.skin, b.skin);
        EXPECT_EQ(a.cavity, b.cavity);
        EXPECT_EQ(a.skull, b.skull);
    });
    const Vec3f brow = usual.from_model({0, -18, 94});
    EXPECT_GT(usual.fields(brow).skin, 0.0f) << "just above the crown";
    EXPECT_LT(large.fields(brow).skin, 0.0f);
}

TEST(Newborn, ShiftedLarynxMovesItsLandmarks) {
    NewbornShape shape;
    apply(AirwayVariant::anterior_larynx, shape);
    const Newborn usual{NewbornShape()};
    const Newborn anterior(shape);
    const Vec3f moved = place_of(anterior, Landmark::glottis) - place_of(usual, Landmark::glottis);
    EXPECT_NEAR(moved.y(), -2.5e-3, 0.1e-3) << "forward is towards smaller y";
    EXPECT_NEAR(moved.z(), 2.0e-3, 0.1e-3);
    EXPECT_EQ(place_of(anterior, Landmark::upper_gum), place_of(usual, Landmark::upper_gum));
    EXPECT_EQ(place_of(anterior, Landmark::carina), place_of(usual, Landmark::carina));
    // The fields moved by the same displacement: values at a landmark are unchanged.
    for (const Landmark which : {Landmark::glottis, Landmark::epiglottis_tip, Landmark::vallecula}) {
        const Fields a = usual.fields(place_of(usual, which));
        const Fields b = anterior.fields(place_of(anterior, which));
        EXPECT_NEAR(a.cavity, b.cavity, 1e-5);
        EXPECT_NEAR(a.epiglottis, b.epiglottis, 1e-5);
    }
}

TEST(Newborn, ShortMandibleRetractsGumAndTongue) {
    const Newborn usual{NewbornShape()};
    const Newborn small(shape_with(&NewbornShape::mandible_scale, 0.8f));
    const float back = place_of(small, Landmark::lower_gum).y() - place_of(usual, Landmark::lower_gum).y();
    // A fifth of the distance from the joint to the gum, 41.5 mm.
    EXPECT_NEAR(back, 0.2f * 41.5e-3f, 0.3e-3f);
    EXPECT_GT(place_of(small, Landmark::tongue_tip).y(), place_of(usual, Landmark::tongue_tip).y());
    EXPECT_EQ(place_of(small, Landmark::upper_gum), place_of(usual, Landmark::upper_gum));
    EXPECT_LT(small.fields(place_of(small, Landmark::lower_gum) - Vec3f(0, 0, 2e-3f)).lower_gum, 0.0f);
}

TEST(Newborn, TongueLandmarksLieOnTongueOfAnySize) {
    for (const float scale : {0.8f, 1.0f, 1.25f, 1.4f}) {
        for (const float jaw : {5.0f * degree, 20.0f * degree}) {
            NewbornShape shape = shape_with(&NewbornShape::tongue_scale, scale);
            shape.jaw_opening = jaw;
            const Newborn newborn(shape);
            const Vec3f dorsum = place_of(newborn, Landmark::tongue_dorsum);
            EXPECT_NEAR(newborn.fields(dorsum).tongue, 0.0f, 1e-5f) << scale;
            EXPECT_LT(newborn.fields(dorsum - Vec3f(0, 0, 1e-3f)).tongue, 0.0f) << scale;
            if (scale < 1.3f) {  // a larger one protrudes from the mouth and is cut 2 mm in front of the face
                const float off = newborn.fields(place_of(newborn, Landmark::tongue_tip)).tongue;
                EXPECT_NEAR(off, 0.0f, 1.5e-3f) << scale;
            }
        }
    }
}

TEST(Newborn, JawOpensByItsAngleAboutTheJoints) {
    const Newborn closed{NewbornShape()};
    const Newborn open(shape_with(&NewbornShape::jaw_opening, 20.0f * degree));
    const Vec3f joint = closed.skeleton().jaw_joint;
    const auto angle = [&](const Newborn& newborn) {
        const Vec3f arm = place_of(newborn, Landmark::lower_gum) - joint;
        return std::atan2(-arm.z(), -arm.y());
    };
    // The condyles slide forward as the mouth opens, which reduces the angle.
    EXPECT_NEAR((angle(open) - angle(closed)) / degree, 20.0f, 2.0f);
    // Between the lips, which are now far apart, there is air on all sides.
    for (const float z : {-3e-3f, 0.0f, 3e-3f}) {
        const Fields f = open.fields(place_of(open, Landmark::mouth_opening) + Vec3f(0, 0, z));
        EXPECT_TRUE(f.skin > 0.0f || f.cavity < 0.0f) << z;
    }
}

TEST(Newborn, HyoidLiesBelowTongueOutsideAirway) {
    const Newborn newborn{NewbornShape()};
    std::size_t inside = 0;
    for_airway(newborn, [&](const Vec3f& point) {
        const Fields f = newborn.fields(point);
        if (f.hyoid < 0.0f) {
            ++inside;
            EXPECT_GT(f.cavity, 0.0f);
            EXPECT_GT(f.mandible, 5e-3f);
            EXPECT_GT(f.larynx, -1e-3f);
        }
    });
    EXPECT_GT(newborn.fields(newborn.from_model({0, 24, -33.5f})).hyoid, 0.0f);
    EXPECT_LT(newborn.fields(newborn.from_model({0, 16.5f, -33.5f})).hyoid, 0.0f);
}

}  // namespace
}  // namespace eti::patient
