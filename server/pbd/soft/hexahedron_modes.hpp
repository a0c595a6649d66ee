// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>

namespace eti::pbd {

// A trilinear cell's corner positions as a sum of modes: with corner numbers v and mode numbers a, both bits
// along the cell's axes, mode a has the sign of the product of the axes in a. Mode 0 is the mean, 1, 2 and 4
// are the mean edges, and the other four are hourglass modes.

/// The four modes that bend and twist a cell without changing its mean edges.
inline constexpr std::array<unsigned, 4> hourglass_modes = {3, 5, 6, 7};

/// Sign of `mode` at a corner: +1 or -1.
[[nodiscard]] constexpr int hexahedron_sign(unsigned mode, unsigned corner) {
    // Each axis of the mode at whose low end the corner lies turns the sign.
    const unsigned turned = mode & ~corner;
    return ((turned >> 0 ^ turned >> 1 ^ turned >> 2) & 1u) != 0 ? -1 : 1;
}

}  // namespace eti::pbd
