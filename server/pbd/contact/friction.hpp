// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// Coulomb friction coefficients.
struct Friction {
    float static_coefficient = 0.0f;  ///< sticking holds up to this times the normal force
    float kinetic_coefficient =
        0.0f;  ///< sliding friction is this times the normal force; at most `static_coefficient`

    constexpr Friction() = default;
    /// One coefficient for both.
    constexpr Friction(float both) : static_coefficient(both), kinetic_coefficient(both) {}
    constexpr Friction(float at_rest, float sliding)
        : static_coefficient(at_rest), kinetic_coefficient(sliding) {}

    /// Fraction of the tangential `wanted` that acts under a `normal` force (or displacement, under a normal
    /// push); 1 while sticking.
    [[nodiscard]] constexpr double share(double wanted, double normal) const {
        return wanted <= static_coefficient * normal ? 1.0 : kinetic_coefficient * normal / wanted;
    }
};

}  // namespace eti::pbd
