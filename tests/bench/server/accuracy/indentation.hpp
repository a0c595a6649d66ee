// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "tests/bench/server/accuracy/block_body.hpp"

namespace eti::bench {

/// A frictionless sphere, or cylinder along x, that is lowered onto a block.
struct Indenter {
    bool sphere = true;
    double x = 0.0, y = 0.0;  ///< [m], of its axis
    double radius = 5e-3;     ///< [m]

    /// Height of its underside over a point, at indentation `depth` [m] of a block `top` [m] high; very large
    /// beside it.
    [[nodiscard]] double height_over(const Vec3d& point, double depth, double top) const;
};

inline constexpr double blade_radius = 5e-3;     ///< [m], of the blade's thickest capsule
inline constexpr double reference_ratio = 0.45;  ///< Poisson's ratio of the references

/// A quarter of a block of 32 x 32 x 16 cells under a sphere with a radius of 16 cells, at any cell size: its
/// corner is the middle of the whole one.
struct HertzBlock {
    static constexpr int cells = 16;
    explicit HertzBlock(double cell);
    int side_mm = 0;
    Indenter sphere;
    /// The closed form [N] for the quarter.
    [[nodiscard]] double force(double depth, double youngs_modulus) const;
};

/// Force [N] at a depth [m], mean over the time at rest there, of an indenter that is pressed into a block on
/// a rigid floor. `mirrored`: the planes x = 0 and y = 0 are planes of symmetry.
[[nodiscard]] double press(BlockBody& body, const Indenter& indenter, double depth, bool mirrored);

/// Force [N] on an indenter over the middle of a block of 20 x 20 x 10 mm, by finite elements on a quarter of
/// it: touched nodes are held at the indenter's height, and those under tension are released.
[[nodiscard]] double reference_force(Indenter indenter, double depth);

}  // namespace eti::bench
