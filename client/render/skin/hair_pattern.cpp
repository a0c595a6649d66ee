// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/hair_pattern.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"

namespace eti::render {
namespace {

// Chosen: strands of 0.06 to 0.15 mm, tapering, and tufts of them that share a direction. A newborn's hair is
// 0.03 to 0.05 mm thick and sticks together.
constexpr int tufts = 60, strands_per_tuft = 9;
constexpr float thinnest_mm = 0.03f, thickest_mm = 0.075f;  // half widths
constexpr float shortest_mm = 4.0f, longest_mm = 11.0f;

}  // namespace

HairPattern hair_pattern(int side) {
    HairPattern pattern{side,
                        std::vector<std::array<std::uint8_t, 2>>(static_cast<std::size_t>(side * side))};
    const float column_mm = HairPattern::across_mm / static_cast<float>(side);
    const float row_mm = HairPattern::along_mm / static_cast<float>(side);
    Random random(7);
    const auto draw = [&](float x, float y, float slope, float bend) {
        const float length = shortest_mm + (longest_mm - shortest_mm) * random.uniform();
        const float half = thinnest_mm + (thickest_mm - thinnest_mm) * random.uniform();
        const auto rank = static_cast<std::uint8_t>(20 + 235 * random.uniform());
        const auto bright = static_cast<std::uint8_t>(90 + 165 * random.uniform());
        for (float s = 0.0f; s < length; s += row_mm) {
            const float t = s / length;
            const float middle = x + slope * s + bend * s * s;
            const float reach = half * std::sqrt(1.0f - t) / column_mm;
            const int row = static_cast<int>(std::floor((y + s) / row_mm)) & (side - 1);
            const int first = static_cast<int>(std::lround(middle / column_mm - reach));
            const int last = std::max(first, static_cast<int>(std::lround(middle / column_mm + reach)) - 1);
            for (int column = first; column <= last; ++column) {
                auto& texel = pattern.texels[static_cast<std::size_t>(row * side + (column & (side - 1)))];
                if (rank > texel[0]) {
                    texel = {rank, bright};
                }
            }
        }
    };
    for (int tuft = 0; tuft < tufts; ++tuft) {
        const float x = HairPattern::across_mm * random.uniform(),
                    y = HairPattern::along_mm * random.uniform();
        const float slope = 0.16f * random.normal(), bend = 0.014f * random.normal();
        for (int strand = 0; strand < strands_per_tuft; ++strand) {
            draw(x + 0.45f * random.normal(), y + 1.5f * random.normal(), slope + 0.05f * random.normal(),
                 bend + 0.006f * random.normal());
        }
    }
    return pattern;
}

}  // namespace eti::render
