// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace eti::render {

/// The numerals printed on a tube, as distance fields (Green 2007, SIGGRAPH courses): round at any
/// magnification. They are drawn from arcs, as engraved lettering is, so that pictures do not depend on an
/// installed font.
struct NumeralAtlas {
    static constexpr std::string_view glyphs = "0123456789.";
    /// A glyph's cell: size [texels], and in heights of a numeral its margin at the left and below.
    static constexpr int cell_width = 40, cell_height = 64;
    static constexpr float cell_span = 1.28f, margin_left = 0.12f, margin_below = 0.14f;
    /// Half width of a stroke, and the distance from it at which the field ends, in heights of a numeral.
    static constexpr float stroke = 0.065f, spread = 0.12f;

    int width = 0, height = 0;
    /// [height | width], the first row at the bottom: 0.5 on the outline, 1 at `spread` within, 0 beyond it.
    std::vector<std::uint8_t> texels;
};

[[nodiscard]] const NumeralAtlas& numeral_atlas();

}  // namespace eti::render
