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

/// Features by which a head is recognised: bone, air within it, skin.
inline constexpr std::size_t sketch_kinds = 3;

/// Bone, inner air and skin of a head image on a coarse grid along LPS.
struct Sketch {
    imaging::Geometry geometry;
    imaging::Bits seen;                                     ///< voxels that the volume covers
    imaging::Bits solid;                                    ///< the patient, without air
    std::array<imaging::Bits, sketch_kinds> bits;           ///< per kind
    std::array<std::vector<float>, sketch_kinds> distance;  ///< [m], to the nearest voxel of the kind
    std::array<std::vector<Vec3d>, sketch_kinds>
        points;  ///< [m], centres of some, but not all, voxels of the kind

    [[nodiscard]] double spacing() const { return geometry.step(0, 0); }
    /// The voxel that contains a point; empty outside the grid.
    [[nodiscard]] std::optional<std::size_t> at(const Vec3d& point) const {
        // Inline and without lround(): called millions of times by the head search.
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
    /// Edge [m] of a cube with the patient's volume.
    [[nodiscard]] double across() const;
};

/// Sketches a volume at some 40 voxels across the patient.
[[nodiscard]] Sketch sketch_volume(const imaging::Volume& volume, const SegmentSettings& settings);

struct Ball {
    Vec3d centre = Vec3d::Zero();
    double radius = 0.0;  ///< [m]
};

/// The largest ball of soft tissue surrounded by bone on most of the sides that the volume covers.
[[nodiscard]] std::optional<Ball> find_cranium(const Sketch& sketch);

/// A parametric newborn's head.
struct Atlas {
    Sketch sketch;
    Ball cranium;                  ///< the largest ball in it
    Vec3d airway = Vec3d::Zero();  ///< [m], centre of the air
};
/// Atlas of a term newborn; `head_scale` below 1 gives a cranium that is small relative to the face, as in
/// older children.
[[nodiscard]] Atlas make_atlas(float head_scale);

/// `count` uniformly distributed directions (Fibonacci lattice).
[[nodiscard]] std::vector<Vec3d> directions(int count);

[[nodiscard]] Vec3d mean_of(const std::vector<Vec3d>& points);

}  // namespace eti::segmentation
