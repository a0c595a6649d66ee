// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "tests/bench/server/block_cases.hpp"

namespace eti::bench {

/// A sphere, or a cylinder along x, that comes down on a block without friction.
struct Indenter {
    bool sphere = true;
    double x = 0.0, y = 0.0;  ///< [m], of its axis
    double radius = 5e-3;     ///< [m]

    /// Height of its underside over a point, pressed `depth` [m] into a block as high as `top` [m]; far above
    /// beside it.
    [[nodiscard]] double height_over(const Vec3d& point, double depth, double top) const;
};

inline constexpr double blade_radius = 5e-3;  ///< [m], of the blade's thickest capsule

/// Depths [m] at which the sphere and the blade are compared; the block is 10 mm high.
[[nodiscard]] inline std::vector<double> indentation_depths() {
    return {0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3};
}

/// A quarter of a block of 32 x 32 x 16 cells under a sphere of 16 cells, whatever these are: its corner is
/// the middle of the whole one.
struct HertzBlock {
    static constexpr int cells = 16;
    explicit HertzBlock(double cell);
    int side_mm = 0;
    Indenter sphere;
    /// The closed form [N] for the quarter.
    [[nodiscard]] double force(double depth, double youngs_modulus) const;
};

/// Presses the indenter into a block on a rigid floor, stage by stage, and lets it come to rest in each.
/// `mirrored`: the planes x = 0 and y = 0 are planes of symmetry. Gives the wall time [ms] per 1/90 s in
/// `frame_ms`.
[[nodiscard]] std::vector<Press> press(BlockBody& body, const Indenter& indenter,
                                       const std::vector<double>& depths, bool mirrored, double& frame_ms);

/// Force [N] on an indenter over the middle of a block of 20 x 20 x 10 mm, by finite elements on a quarter of
/// it: nodes that the indenter touches are held at its height, and those that it would pull are let go.
[[nodiscard]] std::vector<double> reference_forces(Indenter indenter, const std::vector<double>& depths);

}  // namespace eti::bench
