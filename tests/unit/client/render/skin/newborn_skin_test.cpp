// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/newborn_skin.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "client/render/skin/hair_pattern.hpp"

namespace eti {
namespace {

using render::NewbornSkin;

// A newborn's skin by size relative to 3.5 kg.
NewbornSkin skin_of(float size) {
    Landmarks rest = zero_landmarks();
    rest[static_cast<std::size_t>(Landmark::glottis)] = Vec3f(0.0f, 0.04f * size, -0.03f * size);
    return NewbornSkin(rest);
}

constexpr float open_sky = 1.0f;
const Vec3f vertex(0.0f, -35.0f, 90.0f), forehead(0.0f, 42.0f, 45.0f), brow(18.0f, 43.0f, 35.0f),
    chin(0.0f, 50.0f, -25.0f), cheek(30.0f, 35.0f, 0.0f), belly(0.0f, 70.0f, -160.0f);

TEST(NewbornHair, GrowsOnScalpAndBrowsAtTerm) {
    const NewbornSkin term = skin_of(1.0f);
    EXPECT_GT(term.hair(vertex), 0.6f);
    EXPECT_GT(term.hair(brow), 0.35f);
    for (const Vec3f& bare : {forehead, chin, cheek, belly}) {
        EXPECT_LT(term.hair(bare), 0.02f) << bare.transpose();
    }
}

TEST(NewbornHair, IsSparseAndDownyAt28Weeks) {
    const NewbornSkin preterm = skin_of(0.68f);
    EXPECT_LT(preterm.hair(vertex), 0.5f);
    EXPECT_GT(preterm.hair(cheek), 0.1f) << "lanugo";
    EXPECT_LT(preterm.hair(cheek), 0.3f);
    EXPECT_EQ(preterm.hair(belly), 0.0f);
}

TEST(NewbornSkin, IsRedderAndShinierAt28Weeks) {
    const NewbornSkin::Look term = skin_of(1.0f).look(belly, open_sky),
                            preterm = skin_of(0.68f).look(belly, open_sky);
    EXPECT_GT(preterm.colour.x() / preterm.colour.y(), 1.2f * term.colour.x() / term.colour.y());
    EXPECT_GT(preterm.wetness, 2.0f * term.wetness);
}

TEST(NewbornSkin, HandsAndFeetAreAcral) {
    const NewbornSkin term = skin_of(1.0f);
    EXPECT_EQ(term.acral({185.0f, 5.0f, -70.0f}), 1.0f);
    EXPECT_EQ(term.acral({-105.0f, 0.0f, -345.0f}), 1.0f);
    EXPECT_EQ(term.acral(belly), 0.0f);
    EXPECT_EQ(term.hair({185.0f, 5.0f, -70.0f}), 0.0f);
}

TEST(HairPattern, DenserHairShowsMoreStrands) {
    const render::HairPattern pattern = render::hair_pattern(128);
    const auto covered = [&](int density) {
        const auto shown =
            std::ranges::count_if(pattern.texels, [&](const auto& t) { return t[0] > 255 - density; });
        return static_cast<double>(shown) / static_cast<double>(pattern.texels.size());
    };
    EXPECT_GT(covered(255), 0.7);
    EXPECT_LT(covered(100), 0.8 * covered(255));
    EXPECT_GT(covered(100), covered(50));
    EXPECT_GT(covered(50), 0.0);
}

}  // namespace
}  // namespace eti
