// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/volume.hpp"

#include <fmt/format.h>
#include <cmath>

namespace eti::imaging {

namespace {

// [m], voxel spacing in a head: from micro-CT to the coarsest that shows a newborn's airway. Beyond these,
// the file uses another unit, and radii in millimetres would become millions of voxels.
constexpr double min_spacing = 0.05e-3, max_spacing = 20e-3;

}  // namespace

void require_valid(const Geometry& geometry, const std::string& file) {
    constexpr int least = 4;
    double voxels = 1.0;
    for (const int n : geometry.size) {
        voxels *= n;
    }
    const std::string sizes =
        fmt::format("{} x {} x {}", geometry.size[0], geometry.size[1], geometry.size[2]);
    for (const int n : geometry.size) {
        if (n < least) {
            throw VolumeError(
                fmt::format("{}: the volume has {} voxels; expected at least {} along each axis. "
                            "Remedy: give the whole series, not a single slice.",
                            file, sizes, least));
        }
    }
    if (voxels > static_cast<double>(max_voxels)) {
        throw VolumeError(
            fmt::format("{}: the volume has {} = {:.3g} voxels; expected at most {}. Remedy: crop it to "
                        "head and neck, or resample it to larger voxels.",
                        file, sizes, voxels, max_voxels));
    }
    const Vec3d spacing = geometry.spacing();
    if (!geometry.origin.allFinite() || !geometry.step.allFinite() || !(spacing.minCoeff() >= min_spacing) ||
        !(spacing.maxCoeff() <= max_spacing)) {
        throw VolumeError(
            fmt::format("{}: the voxel spacing is {:.4g} x {:.4g} x {:.4g} mm; expected {:g} to {:g} mm. "
                        "Remedy: correct spacing and directions in the program that wrote the file{}.",
                        file, spacing.x() * 1e3, spacing.y() * 1e3, spacing.z() * 1e3, 1e3 * min_spacing,
                        1e3 * max_spacing,
                        1e3 * spacing.minCoeff() >= min_spacing && 1e3 * spacing.maxCoeff() <= max_spacing
                            ? "; they seem to be in metres instead of millimetres"
                            : ""));
    }
    // Product of the sines of the angles between axes: 1 for an orthogonal grid, 0 for a degenerate one.
    const double spanned = geometry.voxel_volume() / spacing.prod();
    if (!(spanned > 0.5)) {
        throw VolumeError(
            fmt::format("{}: the axes' directions are nearly dependent (determinant {:.2g}; expected above "
                        "0.5). Remedy: correct the directions in the program that wrote the file.",
                        file, spanned));
    }
}

void require_finite(const Volume& volume, const std::string& file) {
    std::size_t bad = 0;
    std::size_t first = 0;
    for (std::size_t i = volume.value.size(); i-- > 0;) {
        if (!std::isfinite(volume.value[i])) {
            ++bad;
            first = i;
        }
    }
    if (bad > 0) {
        const auto [x, y, z] = volume.geometry.coordinates(first);
        throw VolumeError(fmt::format(
            "{}: {} voxels are not numbers (NaN or infinite), the first at ({}, {}, {}); expected "
            "Hounsfield units everywhere. Remedy: replace them by -1000 (air).",
            file, bad, x, y, z));
    }
}

}  // namespace eti::imaging
