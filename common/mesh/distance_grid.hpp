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

/// A distance whose direction changes steadily, for what has to come to rest on it.
struct SteadyDistance {
    float distance = 0.0f;                           ///< [m]
    Eigen::Vector3f gradient = Vec3f::Zero();        ///< of it, short of one in the middle between walls
    Eigen::Matrix3f bend = Eigen::Matrix3f::Zero();  ///< [1/m], its second derivatives
};

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

    /// Trilinear distance [m] at `point`; points outside the grid take the nearest border value.
    [[nodiscard]] float distance(const Vec3f& point) const;

    /// Distance and unit gradient at `point` (gradient of the trilinear interpolant).
    [[nodiscard]] DistanceSample sample(const Vec3f& point) const;

    /// By quadratic B-splines about the nodes, with their exact derivatives: the gradient is continuous,
    /// where the trilinear one jumps at every face of a cell. Linear functions are reproduced; a bend b [1/m]
    /// shifts the distance by b spacing^2 / 8 (de Boor 1978). Points outside the grid take the border's.
    [[nodiscard]] SteadyDistance steady(const Vec3f& point) const;
};

}  // namespace eti
