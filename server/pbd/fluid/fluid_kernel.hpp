// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "common/math/transform.hpp"

namespace eti::pbd {

/// Smoothing kernel of the fluid: Wendland C2 in three dimensions (Wendland 1995; Dehnen & Aly 2012, table
/// 1). Unlike splines it has no pairing instability, and W'(r) / r is a polynomial.
struct FluidKernel {
    explicit FluidKernel(float support_radius);

    float radius;          ///< [m], support radius
    float inverse_radius;  ///< [1/m]
    float peak;            ///< [1/m^3], value at distance 0
    float slope;           ///< [1/m^5], minus the limit of W'(r) / r at distance 0

    /// W [1/m^3] at distance `r` [m].
    [[nodiscard]] float value(float r) const;
    /// W'(r) / r [1/m^5], never positive: times the vector from the neighbour, it gives the gradient.
    [[nodiscard]] float gradient_over_distance(float r) const;
    /// Inverse of the sum of W over a cubic lattice, including the point itself [m^3]: the volume per
    /// particle for which the lattice has rest density.
    [[nodiscard]] float lattice_volume(float spacing) const;
};

/// Normalised attraction between two fluid particles: negative (repulsion) below a quarter of the kernel
/// radius, 1 at half of it, 0 at the radius. A polynomial with the zero and the peak of the spline of Akinci,
/// Akinci & Teschner 2013, eq. 2. `q`: distance over kernel radius, at most 1.
template <class Number>
[[gnu::always_inline]] inline void cohesion_shape(const Number& q, Number& shape) {
    shape = 16.0f * (1.0f - q) * (1.0f - q) * (q - 0.25f);
}
template <std::floating_point Number>
[[nodiscard]] Number cohesion_shape(Number q) {
    Number shape;
    cohesion_shape(q, shape);
    return shape;
}

/// Force [N] by which cohesion_shape() is multiplied so that the liquid has surface tension `tension` [N/m].
/// From the integral of Kirkwood & Buff 1949 for a sharp surface and uniform particles (Fowler 1937): tension
/// = pi / 8 n^2 integral of r^4 f(r) dr, with n = 1 / `particle_volume` [m^3].
[[nodiscard]] float cohesion_strength(float tension, float particle_volume, float kernel_radius);

/// Effect of a flat wall on a particle: the fluid's pair terms integrated over the half-space behind the
/// surface, as if it were filled with fluid at rest density (density maps: Koschier & Bender 2017, with the
/// wall assumed flat within the kernel).
struct WallTerms {
    float density = 0.0f;   ///< fraction of rest density that the wall contributes
    float gradient = 0.0f;  ///< [1/m], derivative of `density` by distance; never positive
    float adhesion = 0.0f;  ///< [m^3], integral of cohesion_shape()'s component towards the wall
    float drag = 0.0f;      ///< [1/m^2], integral of -W'(r) / r times the squared tangential part of the
                            ///< direction
};

class WallTable {
  public:
    explicit WallTable(const FluidKernel& kernel);
    /// Terms at `distance` [m] from the surface. Negative distances count as 0; beyond the radius all terms
    /// are 0.
    [[nodiscard]] WallTerms at(float distance) const;

  private:
    static constexpr std::size_t intervals = 128;
    std::array<WallTerms, intervals + 1> entry_{};
    float scale_;
};

}  // namespace eti::pbd
