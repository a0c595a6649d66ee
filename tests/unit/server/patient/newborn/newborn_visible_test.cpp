// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {
namespace {

// Model coordinates: x left, y anterior, z superior; millimetres of a 3.5 kg newborn.
class NewbornSeen : public testing::Test {
  protected:
    [[nodiscard]] VisibleFields at(float x, float y, float z) const {
        return newborn_.visible_fields(newborn_.from_model({x, y, z}));
    }
    [[nodiscard]] bool tissue(float x, float y, float z) const {
        const VisibleFields s = at(x, y, z);
        return std::min({s.body, s.tongue, s.epiglottis}) < 0.0f;
    }
    [[nodiscard]] Tissue label(float x, float y, float z) const {
        return newborn_.visible_tissue(newborn_.from_model({x, y, z}));
    }
    /// Half the width of the air about the midline.
    [[nodiscard]] float half_width(float y, float z) const {
        float x = 0.0f;
        while (x < 8.0f && !tissue(x, y, z)) {
            x += 0.02f;
        }
        return x;
    }
    Newborn newborn_{NewbornShape()};
};

// Sato 2015 (Laryngoscope 125:E186): 5.4 mm long at rest. From the commissure backwards it widens steadily up
// to the arytenoids, like an isosceles triangle.
TEST_F(NewbornSeen, GlottisIsTriangleBetweenVocalCords) {
    constexpr float z = -37.5f;
    float front = 5.6f, back = 5.6f;
    while (!tissue(0.0f, front, z)) {
        front += 0.02f;
    }
    while (!tissue(0.0f, back, z)) {
        back -= 0.02f;
    }
    EXPECT_NEAR(front - back, 5.4f, 0.3f);
    const float length = front - back;
    const float quarter = half_width(front - 0.25f * length, z);
    EXPECT_NEAR(half_width(front - 0.5f * length, z), 2.0f * quarter, 0.2f * quarter);
    EXPECT_NEAR(half_width(front - 0.75f * length, z), 3.0f * quarter, 0.3f * quarter);
    for (const float share : {0.25f, 0.5f}) {
        const float y = front - share * length;
        const float edge = half_width(y, z) + 0.1f;
        EXPECT_EQ(label(edge, y, z), Tissue::vocal_cord) << share;
        // Visible from above between the false cords, which are wider apart.
        EXPECT_GT(half_width(y, -34.7f), half_width(y, z) + 0.8f) << share;
    }
    EXPECT_NE(label(0.0f, back - 0.1f, z), Tissue::vocal_cord) << "the interarytenoid wall is no cord";
}

// The measured contour passes through the visible surface: its polygon is the visible opening.
TEST_F(NewbornSeen, GlottisContourMatchesDrawnOpening) {
    const auto contour = newborn_.glottis_contour();
    const Vec3f middle = newborn_.landmarks()[static_cast<std::size_t>(Landmark::glottis)];
    for (const Vec3f& p : contour) {
        EXPECT_GT(newborn_.visible_fields(middle + 0.97f * (p - middle)).body, 0.0f);
        EXPECT_LT(newborn_.visible_fields(middle + 1.05f * (p - middle)).body, 0.0f);
    }
}

// From the arytenoids forwards, a wall without holes separates inlet and piriform recesses up to the
// epiglottis.
TEST_F(NewbornSeen, AryepiglotticFoldsHaveNoHoles) {
    for (const float z : {-33.0f, -32.0f, -31.5f}) {
        for (int degrees = -60; degrees <= 240; degrees += 2) {
            const float angle = static_cast<float>(degrees) * std::numbers::pi_v<float> / 180.0f;
            bool met = false;
            for (float r = 0.0f; r < 6.5f && !met; r += 0.05f) {
                met = tissue(r * std::cos(angle), 5.4f + r * std::sin(angle), z);
            }
            EXPECT_TRUE(met) << "at " << degrees << " deg, z " << z;
        }
    }
    // The border rises from behind to the plate's edge.
    const auto top = [&](float x, float y) {
        float z = -33.0f;
        while (z < -20.0f && tissue(x, y, z)) {
            z += 0.05f;
        }
        return z;
    };
    EXPECT_GT(top(4.1f, 5.0f), top(3.9f, 3.6f) + 0.3f);
    EXPECT_LT(at(4.1f, 5.4f, -28.6f).epiglottis, 0.5e-3f) << "it ends at the plate";
}

TEST_F(NewbornSeen, TuberclesFlankInterarytenoidNotch) {
    const auto top = [&](float x, float y) {
        float z = -36.0f;
        while (z < -26.0f && tissue(x, y, z)) {
            z += 0.05f;
        }
        return z;
    };
    const float corniculate = top(1.65f, 1.7f), cuneiform = top(3.5f, 2.8f);
    EXPECT_GT(corniculate, top(0.0f, 1.7f) + 1.5f) << "the interarytenoid notch";
    EXPECT_LT(corniculate, top(0.0f, 1.7f) + 2.3f) << "mucosa bridges it";
    EXPECT_GT(corniculate, top(2.55f, 2.1f) + 0.15f) << "a dip between the tubercles";
    EXPECT_GT(cuneiform, top(2.55f, 2.1f) + 0.15f);
}

TEST_F(NewbornSeen, VentricleLiesBetweenFoldAndCord) {
    for (const float y : {5.0f, 6.0f}) {
        const float fold = half_width(y, -34.8f), ventricle = half_width(y, -36.0f);
        EXPECT_GT(ventricle, fold + 0.6f) << y;
        EXPECT_GT(half_width(y, -32.5f), fold + 0.2f) << "the vestibule above, y " << y;
        EXPECT_GT(fold, half_width(y, -37.5f)) << "the cord is visible beside it, y " << y;
    }
}

// Above the contour that is measured, each cord bulges where its ligament ends.
TEST_F(NewbornSeen, VocalProcessBulgesAboveGlottis) {
    const auto leaned = [&](float y) { return half_width(y, -37.15f) - half_width(y, -37.5f); };
    EXPECT_LT(leaned(4.5f), leaned(6.0f) - 0.08f);
}

// Pits on both sides of the median fold, with lateral folds beside them.
TEST_F(NewbornSeen, ValleculaeLieBetweenGlossoepiglotticFolds) {
    constexpr float z = -27.6f;
    EXPECT_TRUE(tissue(0.0f, 9.0f, z));
    EXPECT_FALSE(tissue(2.5f, 9.0f, z));
    EXPECT_FALSE(tissue(-2.5f, 9.0f, z));
    EXPECT_TRUE(tissue(6.0f, 6.4f, z));
}

TEST_F(NewbornSeen, FoldWeightFallsAwayFromEpiglottis) {
    const auto share = [&](float x, float y, float z) {
        return newborn_.epiglottis_coupling(newborn_.from_model({x, y, z}));
    };
    EXPECT_GT(share(4.0f, 5.2f, -28.4f), 0.6f);
    EXPECT_LT(share(3.8f, 3.6f, -29.8f), share(4.0f, 5.2f, -28.4f));
    EXPECT_LT(share(2.0f, 1.7f, -30.0f), 0.1f);
    EXPECT_EQ(share(2.5f, 5.6f, -37.5f), 0.0f) << "a cord";
    EXPECT_EQ(share(0.0f, 0.0f, -20.0f), 0.0f) << "the throat's wall behind the tip";
}

TEST_F(NewbornSeen, LipsEndAtVermilionBorderAndTrunkIsClothed) {
    const auto outermost = [&](float x, float z) {
        float y = 70.0f;
        while (at(x, y, z).body > 0.0f && y > 20.0f) {
            y -= 0.05f;
        }
        return y;
    };
    for (const float z : {-5.5f, -11.0f}) {
        EXPECT_EQ(label(0.0f, outermost(0.0f, z), z), Tissue::lip) << z;
    }
    for (const float z : {2.0f, -15.0f}) {
        EXPECT_EQ(label(0.0f, outermost(0.0f, z), z), Tissue::soft) << z;
    }
    EXPECT_EQ(label(20.0f, outermost(20.0f, -6.0f), -6.0f), Tissue::soft) << "a cheek";
    const float clothed = BodyShape::is_available() ? -200.0f : -110.0f;
    EXPECT_LT(at(0.0f, outermost(0.0f, clothed) + 1.0f, clothed).cloth, 0.0f);
    EXPECT_GT(at(0.0f, outermost(0.0f, -70.0f) + 1.0f, -70.0f).cloth, 0.0f) << "the shoulders are bare";
}

// The data have a pit at the outer corner of the eye, and no line between the lids.
TEST_F(NewbornSeen, LidsAreRoundAndMeetInLine) {
    if (!BodyShape::is_available()) {
        GTEST_SKIP() << "built without a body's data";
    }
    const auto front = [&](float x, float z) {
        float y = 60.0f;
        while (at(x, y, z).body > 0.0f && y > 20.0f) {
            y -= 0.05f;
        }
        return y;
    };
    // A lid of 11.5 mm radius falls by 1.3 mm a millimetre at 9 mm from its middle.
    for (float x = 11.0f; x < 28.0f; x += 1.0f) {
        EXPECT_LT(std::fabs(front(x + 1.0f, 27.0f) - front(x, 27.0f)), 1.5f) << x;
    }
    EXPECT_LT(front(19.0f, 24.3f), front(19.0f, 26.5f) - 0.3f) << "the line between the lids";
}

// Otherwise sections would show bare bone. Near the mouth's cavity drawn gums are higher than physical ones.
TEST_F(NewbornSeen, SkinCoversBones) {
    int count = 0;
    for (float z = -90.0f; z < 92.0f; z += 2.0f) {
        for (float y = -74.0f; y < 60.0f; y += 2.0f) {
            for (float x = 0.0f; x < 48.0f; x += 2.0f) {
                const Fields f = newborn_.fields(newborn_.from_model({x, y, z}));
                if (std::min({f.skull, f.mandible, f.spine, f.hyoid}) < -0.5e-3f && f.cavity > 4e-3f) {
                    EXPECT_LT(at(x, y, z).body, 0.0f) << x << " " << y << " " << z;
                    ++count;
                }
            }
        }
    }
    EXPECT_GT(count, 2000);
}

// Tools stop at the shell of the particles' fields: the drawn surface must be there as well.
TEST_F(NewbornSeen, DrawnAirwayMatchesContactShell) {
    double off = 0.0;
    int count = 0;
    for (float z = -60.0f; z < 0.0f; z += 0.7f) {
        for (float y = -5.0f; y < 44.0f; y += 0.7f) {
            for (float x = 0.0f; x < 8.0f; x += 0.7f) {
                const Vec3f p = newborn_.from_model({x, y, z});
                const Fields f = newborn_.fields(p);
                if (std::fabs(f.cavity) < 0.3e-3f && f.skin < -3e-3f && f.tongue > 0.5e-3f) {
                    off += static_cast<double>(std::fabs(newborn_.visible_fields(p).body));
                    ++count;
                }
            }
        }
    }
    ASSERT_GT(count, 300);
    // Folds, tubercles and pillars are new; everything else is unchanged.
    EXPECT_LT(off / count, 0.8e-3);
}

}  // namespace
}  // namespace eti::patient
