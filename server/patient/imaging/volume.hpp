// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::imaging {

/// An error in a volume that the user can correct; the message names the file, the finding, the expectation
/// and the remedy.
class VolumeError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Position of a volume's voxels: centre of voxel (i, j, k) = origin + step * (i, j, k).
struct Geometry {
    std::array<int, 3> size{};     ///< voxels along the three index axes, x fastest
    Vec3d origin = Vec3d::Zero();  ///< [m], DICOM LPS
    Eigen::Matrix3d step = 1e-3 * Eigen::Matrix3d::Identity();  ///< [m] columns: step along each index axis

    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
               static_cast<std::size_t>(size[2]);
    }
    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(x);
    }
    [[nodiscard]] std::array<int, 3> coordinates(std::size_t index) const {
        const auto nx = static_cast<std::size_t>(size[0]);
        const auto ny = static_cast<std::size_t>(size[1]);
        return {static_cast<int>(index % nx), static_cast<int>(index / nx % ny),
                static_cast<int>(index / nx / ny)};
    }
    [[nodiscard]] bool contains(int x, int y, int z) const {
        return x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2];
    }
    /// Centre of a voxel [m]; fractional indices lie between centres.
    [[nodiscard]] Vec3d point(double x, double y, double z) const { return origin + step * Vec3d(x, y, z); }
    /// The inverse of point().
    [[nodiscard]] Vec3d to_index(const Vec3d& point) const { return step.inverse() * (point - origin); }
    /// [m] along the three index axes.
    [[nodiscard]] Vec3d spacing() const { return step.colwise().norm().transpose(); }
    [[nodiscard]] double voxel_volume() const { return std::abs(step.determinant()); }  ///< [m^3]
};

/// A scalar per voxel, x fastest.
template <class T>
struct Image {
    Geometry geometry;
    std::vector<T> value;

    [[nodiscard]] T at(int x, int y, int z) const { return value[geometry.index(x, y, z)]; }
};

/// CT in Hounsfield units.
using Volume = Image<float>;
using Mask = Image<std::uint8_t>;

/// Maximum number of voxels of a volume: 1 GiB of floats.
inline constexpr std::size_t max_voxels = std::size_t{1} << 28;

/// Throws VolumeError, starting with `file`, unless the volume has at least four voxels along each axis and
/// at most `max_voxels`, linearly independent directions and finite values.
void require_valid(const Geometry& geometry, const std::string& file);
void require_finite(const Volume& volume, const std::string& file);

}  // namespace eti::imaging
