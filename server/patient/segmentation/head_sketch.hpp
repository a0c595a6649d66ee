// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/patient/imaging/filter.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

struct SegmentSettings;

/// What a head is recognised by: bone, air within it, skin.
inline constexpr std::size_t sketch_kinds = 3;

/// Where bone, inner air and skin lie in a picture of a head on a coarse grid along LPS.
struct Sketch {
    imaging::Geometry geometry;
    imaging::Bits seen;                                     ///< what the volume shows
    imaging::Bits solid;                                    ///< the patient, without air
    std::array<imaging::Bits, sketch_kinds> bits;           ///< of each kind
    std::array<std::vector<float>, sketch_kinds> distance;  ///< [m] to the nearest voxel of the kind
    std::array<std::vector<Vec3d>, sketch_kinds>
        points;  ///< [m], centres of voxels of the kind, some of them

    [[nodiscard]] double spacing() const { return geometry.step(0, 0); }
    /// The voxel that holds a point; nothing outside the grid.
    [[nodiscard]] std::optional<std::size_t> at(const Vec3d& point) const {
        // In the header and without a call of lround: the search for the head asks millions of times.
        const Vec3d i = (point - geometry.origin) / spacing();
        std::array<int, 3> voxel{};
        for (std::size_t k = 0; k < 3; ++k) {
            const double along = i[static_cast<Eigen::Index>(k)];
            if (!(along > -0.5 && along < geometry.size[k] - 0.5)) {
                return std::nullopt;
            }
            voxel[k] = static_cast<int>(along + 0.5);
        }
        return geometry.index(voxel[0], voxel[1], voxel[2]);
    }
    /// Edge [m] of a cube as large as the patient.
    [[nodiscard]] double across() const;
};

/// A coarse picture of what the volume shows: some 40 voxels across the patient.
[[nodiscard]] Sketch sketch_volume(const imaging::Volume& volume, const SegmentSettings& settings);

struct Ball {
    Vec3d centre = Vec3d::Zero();
    double radius = 0.0;  ///< [m]
};

/// The largest ball of soft tissue that bone surrounds on most of the sides that the volume shows.
[[nodiscard]] std::optional<Ball> find_cranium(const Sketch& sketch);

/// A parametric newborn's head.
struct Atlas {
    Sketch sketch;
    Ball cranium;                  ///< the largest ball in it
    Vec3d airway = Vec3d::Zero();  ///< [m], middle of the air
};
/// That of a term newborn; a `head_scale` below 1 has a cranium small against its face, as older children do.
[[nodiscard]] Atlas make_atlas(float head_scale);

/// `count` directions spread evenly over the sphere (Fibonacci's lattice).
[[nodiscard]] std::vector<Vec3d> directions(int count);

[[nodiscard]] Vec3d mean_of(const std::vector<Vec3d>& points);

}  // namespace eti::segmentation
