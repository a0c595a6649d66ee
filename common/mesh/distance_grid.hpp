// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "common/math/transform.hpp"

namespace eti {

/// A distance and its direction of steepest increase.
struct DistanceSample {
    float distance = 0.0f;          ///< [m]
    Vec3f normal = Vec3f::UnitZ();  ///< unit, away from the solid
};

/// A distance with a continuous gradient, for bodies that come to rest on the surface.
struct SplineDistance {
    float distance = 0.0f;                           ///< [m]
    Eigen::Vector3f gradient = Vec3f::Zero();        ///< shorter than one midway between walls
    Eigen::Matrix3f bend = Eigen::Matrix3f::Zero();  ///< [1/m], second derivatives
};

/// Nodes along each axis of a grid from `low` that covers the box up to `high`.
[[nodiscard]] std::array<int, 3> grid_nodes(const Vec3f& low, const Vec3f& high, float spacing);

/// Signed distances on a regular grid, trilinear between nodes; negative inside the solid.
struct DistanceGrid {
    Vec3f origin = Vec3f::Zero();  ///< [m], node (0, 0, 0)
    float spacing = 1e-3f;         ///< [m]
    std::array<int, 3> size{};     ///< nodes along x, y, z
    std::vector<float> value;      ///< [m], x fastest

    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(x);
    }
    [[nodiscard]] Vec3f node(int x, int y, int z) const {
        return origin + spacing * Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    }

    /// Trilinear distance [m] at `point`; outside the grid, the nearest border value.
    [[nodiscard]] float distance(const Vec3f& point) const;

    /// Distance and unit gradient at `point` (gradient of the trilinear interpolant).
    [[nodiscard]] DistanceSample sample(const Vec3f& point) const;

    /// Quadratic B-spline interpolation of the node values with its exact derivatives. Its gradient is
    /// continuous; the trilinear one jumps at every cell face. Linear functions are reproduced; a second
    /// derivative b [1/m] shifts the distance by b spacing^2 / 8 (de Boor 1978). Points outside the grid take
    /// the border's value.
    [[nodiscard]] SplineDistance spline_sample(const Vec3f& point) const;
};

}  // namespace eti
