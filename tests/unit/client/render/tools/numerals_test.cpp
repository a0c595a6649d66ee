// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/numerals.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace eti::render {
namespace {

constexpr int glyph_width = NumeralAtlas::cell_width, glyph_height = NumeralAtlas::cell_height;

int texel(std::size_t glyph, int x, int y) {
    const NumeralAtlas& atlas = numeral_atlas();
    const int column = static_cast<int>(glyph) * glyph_width + x;
    return atlas.texels[static_cast<std::size_t>(y * atlas.width + column)];
}

// Connected regions of the cell's texels that are ink, or are not.
int regions(std::size_t glyph, bool ink) {
    std::set<std::pair<int, int>> left;
    for (int y = 0; y < glyph_height; ++y) {
        for (int x = 0; x < glyph_width; ++x) {
            if ((texel(glyph, x, y) > 127) == ink) {
                left.insert({x, y});
            }
        }
    }
    int count = 0;
    for (; !left.empty(); ++count) {
        std::vector<std::pair<int, int>> front{*left.begin()};
        left.erase(left.begin());
        while (!front.empty()) {
            const auto [x, y] = front.back();
            front.pop_back();
            for (const auto& next : {std::pair{x + 1, y}, {x - 1, y}, {x, y + 1}, {x, y - 1}}) {
                if (left.erase(next) > 0) {
                    front.push_back(next);
                }
            }
        }
    }
    return count;
}

TEST(Numerals, HaveTheDigitsTopology) {
    // Enclosed counters of 0 to 9 and the point; each is one stroke of ink.
    const std::array<int, 11> counters{1, 0, 0, 0, 1, 0, 1, 0, 2, 1, 0};
    for (std::size_t glyph = 0; glyph < counters.size(); ++glyph) {
        EXPECT_EQ(regions(glyph, true), 1) << NumeralAtlas::glyphs[glyph];
        EXPECT_EQ(regions(glyph, false), 1 + counters[glyph]) << NumeralAtlas::glyphs[glyph];
    }
}

TEST(Numerals, FieldIsDistanceToOutline) {
    // A distance grows by at most one texel a texel; coarser steps would show as blocks when magnified.
    constexpr float heights = NumeralAtlas::cell_span / glyph_height;
    const int most = static_cast<int>(std::ceil(255.0f * 0.5f * heights / NumeralAtlas::spread)) + 1;
    int steps = 0;
    for (std::size_t glyph = 0; glyph < NumeralAtlas::glyphs.size(); ++glyph) {
        for (int y = 1; y < glyph_height; ++y) {
            for (int x = 1; x < glyph_width; ++x) {
                EXPECT_LE(std::abs(texel(glyph, x, y) - texel(glyph, x - 1, y)), most);
                EXPECT_LE(std::abs(texel(glyph, x, y) - texel(glyph, x, y - 1)), most);
                steps += texel(glyph, x, y) > 0 && texel(glyph, x, y) < 255 ? 1 : 0;
            }
        }
        for (int y = 0; y < glyph_height; ++y) {
            EXPECT_LT(texel(glyph, 0, y), 127) << "no ink at a cell's edge, which neighbours share";
            EXPECT_LT(texel(glyph, glyph_width - 1, y), 127);
        }
    }
    EXPECT_GT(steps, 1000);
}

}  // namespace
}  // namespace eti::render
