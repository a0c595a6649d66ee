// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace eti::render {

/// A newborn's fine short hair lying on the skin, as a rectangle that repeats: strands run along the rows'
/// order.
struct HairPattern {
    static constexpr float across_mm = 7.0f, along_mm = 14.0f;  ///< of a 3.5 kg newborn

    int side = 0;  ///< texels in both directions
    /// [row][column], each 0-255: rank of the strand that lies on top, so that hair of density d shows the
    /// strands above 1 - d; its brightness.
    std::vector<std::array<std::uint8_t, 2>> texels;
};

/// The same pattern on every machine. `side`: a power of two.
[[nodiscard]] HairPattern hair_pattern(int side = 256);

}  // namespace eti::render
