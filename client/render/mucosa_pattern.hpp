// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace eti::render {

/// Detail of mucosa for a lens ten millimetres away, as a square that repeats. Baked, because a fragment
/// shader cannot draw vessels that branch and end: contours and ridges of noise close to rings.
struct MucosaPattern {
    /// [m], period on the surface: longer than the part that the lens's light covers.
    static constexpr float period = 12e-3f;
    /// Slopes are stored from -`steepest` to `steepest`.
    static constexpr float steepest = 0.5f;

    int side = 0;  ///< texels
    /// [row][column], each 0-255: blood in superficial vessels; slope of the surface along column and row
    /// (127.5 is flat); mottling by the bed of capillaries.
    std::vector<std::array<std::uint8_t, 4>> texels;
};

/// The same pattern on every machine. `side`: a power of two; 512 gives texels of 23 um.
[[nodiscard]] MucosaPattern mucosa_pattern(int side = 512);

}  // namespace eti::render
