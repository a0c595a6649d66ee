// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "common/math/transform.hpp"

namespace eti::pbd {

/// Smoothing kernel of the fluid: Wendland C2 in three dimensions (Wendland 1995; Dehnen & Aly 2012,
/// table 1). Unlike splines it does not let particles pair up, and its gradient over the distance is a
/// plain polynomial.
struct FluidKernel {
    explicit FluidKernel(float support_radius);

    float radius;          ///< [m], beyond which the kernel is zero
    float inverse_radius;  ///< [1/m]
    float peak;            ///< [1/m^3], value at distance 0
    float slope;           ///< [1/m^5], minus the limit of W'(r) / r at distance 0

    /// W [1/m^3] at distance `r` [m].
    [[nodiscard]] float value(float r) const;
    /// W'(r) / r [1/m^5], never positive: the gradient is this times the vector from the neighbour.
    [[nodiscard]] float gradient_over_distance(float r) const;
    /// Inverse of the sum of W over a cubic lattice, itself included [m^3]: the volume each particle stands
    /// for if the lattice is to have rest density.
    [[nodiscard]] float lattice_volume(float spacing) const;
};

/// Attraction between two fluid particles over its greatest value: negative (repulsion) below a quarter of
/// the kernel radius, 1 at half of it, 0 at the radius. A polynomial with the zero and the peak of the
/// spline of Akinci, Akinci & Teschner 2013, eq. 2. `q` is the distance over the kernel radius, at most 1.
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

/// Force [N] that cohesion_shape is to be multiplied by, so that the liquid has surface tension
/// `tension` [N/m]: the integral of Kirkwood & Buff 1949 for a sharp surface and uniform particles
/// (Fowler 1937), tension = pi / 8 n^2 integral of r^4 f(r) dr, with n one over `particle_volume` [m^3].
[[nodiscard]] float cohesion_strength(float tension, float particle_volume, float kernel_radius);

/// What a flat wall does to a particle at some distance from its surface: the fluid's pair terms
/// integrated over the half-space behind the surface, as if that were full of fluid at rest density
/// (density maps: Koschier & Bender 2017, with the wall taken as flat within the kernel).
struct WallTerms {
    float density = 0.0f;   ///< part of rest density that the wall makes up for
    float gradient = 0.0f;  ///< [1/m], its derivative by distance; never positive
    float adhesion = 0.0f;  ///< [m^3], cohesion_shape's component towards the wall, integrated
    float drag = 0.0f;      ///< [1/m^2], -W'(r) / r times the squared tangential part of the direction
};

class WallTable {
  public:
    explicit WallTable(const FluidKernel& kernel);
    /// At `distance` [m] from the surface; 0 is taken for anything less, beyond the radius all are 0.
    [[nodiscard]] WallTerms at(float distance) const;

  private:
    static constexpr std::size_t intervals = 128;
    std::array<WallTerms, intervals + 1> entry_{};
    float scale_;
};

}  // namespace eti::pbd
