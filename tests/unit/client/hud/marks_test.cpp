// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/marks.hpp"

#include <gtest/gtest.h>
#include <imgui.h>

#include <cfloat>

namespace eti {
namespace {

using Eigen::Vector2f;

struct Box {
    Vector2f low, high;
};

class Labels : public ::testing::Test {
  protected:
    Labels() {
        font_ = atlas_.AddFontDefault();
        atlas_.Build();
    }
    static hud::Mark dot(float x, float y, std::string text, bool left = false) {
        return {{x, y}, {x, y}, hud::Level::good, std::move(text), left};
    }
    [[nodiscard]] Box box(const hud::Mark& mark) const {
        const ImVec2 size = font_->CalcTextSizeA(font_->FontSize, FLT_MAX, 0.0f, mark.text.c_str());
        const Vector2f low = mark.to + *mark.label;
        return {low, low + Vector2f(size.x, size.y)};
    }
    static bool meet(const Box& a, const Box& b) {
        return (a.low.array() < b.high.array()).all() && (b.low.array() < a.high.array()).all();
    }

    ImFontAtlas atlas_;
    ImFont* font_;
};

TEST_F(Labels, CrowdedLabelsDoNotOverlap) {
    hud::Tile tile{"section", 100, 50, 300, 150};
    for (int i = 0; i < 6; ++i) {
        tile.marks.push_back(dot(250.0f + 3.0f * static_cast<float>(i), 120.0f, "oesophagus", i % 2 == 0));
    }
    hud::place_labels(tile, *font_);
    for (std::size_t i = 0; i < tile.marks.size(); ++i) {
        ASSERT_TRUE(tile.marks[i].label) << i;
        const Box one = box(tile.marks[i]);
        EXPECT_GE(one.low.x(), 100.0f);
        EXPECT_GE(one.low.y(), 50.0f);
        EXPECT_LE(one.high.x(), 400.0f);
        EXPECT_LE(one.high.y(), 200.0f);
        for (std::size_t j = 0; j < tile.marks.size(); ++j) {
            const Vector2f centre = tile.marks[j].to, reach(5.0f, 5.0f);
            EXPECT_FALSE(meet(one, {centre - reach, centre + reach})) << i << " hides the dot " << j;
            EXPECT_TRUE(i == j || !meet(one, box(tile.marks[j]))) << i << " and " << j;
        }
    }
}

TEST_F(Labels, SitBesideTheirMarkIfSpaceIsFree) {
    hud::Tile tile{"eye", 0, 0, 300, 150};
    tile.marks = {dot(150.0f, 75.0f, "blade"), dot(150.0f, 20.0f, "1.0 N", true)};
    hud::place_labels(tile, *font_);
    EXPECT_FLOAT_EQ(tile.marks[0].label->x(), 10.0f);
    EXPECT_FLOAT_EQ(box(tile.marks[1]).high.x(), 140.0f);
    // At the tile's edge the text moves to the other side.
    tile.marks = {dot(290.0f, 75.0f, "blade")};
    hud::place_labels(tile, *font_);
    EXPECT_FLOAT_EQ(box(tile.marks[0]).high.x(), 280.0f);
}

TEST_F(Labels, KeepClearOfBoxesAndAreHiddenBeneath) {
    hud::Tile tile{"eye", 0, 0, 300, 150};
    const hud::Box box{{155.0f, 0.0f}, {300.0f, 150.0f}};
    tile.marks = {dot(140.0f, 75.0f, "blade"), dot(200.0f, 75.0f, "tongue")};
    hud::place_labels(tile, *font_, {&box, 1});
    ASSERT_TRUE(tile.marks[0].label);
    EXPECT_LE(this->box(tile.marks[0]).high.x(), 155.0f);
    EXPECT_FALSE(tile.marks[1].label);
    // Without room for it there is no text rather than one upon another.
    tile = {"eye", 0, 0, 300, 18};
    tile.marks = {dot(150.0f, 9.0f, std::string(30, 'm')), dot(152.0f, 9.0f, std::string(30, 'm'))};
    hud::place_labels(tile, *font_);
    EXPECT_FALSE(tile.marks[0].label && tile.marks[1].label);
}

TEST_F(Labels, OutsideTileOnlyCrossingLinesAreLabelled) {
    hud::Tile tile{"section", 0, 0, 300, 150};
    tile.marks = {dot(320.0f, 75.0f, "blade"),
                  {{150.0f, 75.0f}, {150.0f, 900.0f}, hud::Level::neutral, "throat"},
                  {{-9.0f, -9.0f}, {-50.0f, -50.0f}, hud::Level::neutral, "mouth"}};
    hud::place_labels(tile, *font_);
    EXPECT_FALSE(tile.marks[0].label);
    EXPECT_FALSE(tile.marks[2].label);
    ASSERT_TRUE(tile.marks[1].label);
    EXPECT_LE(box(tile.marks[1]).high.y(), 150.0f);
    EXPECT_GE(box(tile.marks[1]).low.y(), 100.0f);
}

}  // namespace
}  // namespace eti
