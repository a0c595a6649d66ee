// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// Coulomb's coefficients.
struct Friction {
    float stick = 0.0f;  ///< static: what is at rest stays so up to this times the normal force
    float slide = 0.0f;  ///< kinetic: what slides is held back by this times it; at most `stick`

    constexpr Friction() = default;
    /// One coefficient for rest and sliding.
    constexpr Friction(float both) : stick(both), slide(both) {}
    constexpr Friction(float at_rest, float sliding) : stick(at_rest), slide(sliding) {}

    /// How much of a tangential `wanted` acts under a `normal` force (or of ways, under a push): all while
    /// it sticks.
    [[nodiscard]] constexpr double share(double wanted, double normal) const {
        return wanted <= stick * normal ? 1.0 : slide * normal / wanted;
    }
};

}  // namespace eti::pbd
