// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "common/mesh/check.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

struct SurfaceSettings {
    // Where a coarse surface would cross itself it gets more triangles than these.
    std::size_t skin_triangles = 40000;
    std::size_t bone_triangles = 60000;
    std::size_t airway_triangles = 20000;
    /// Passes of Taubin's filter; more remove more noise and more fine detail.
    int smoothing = 5;
    float air_below = SegmentSettings().air_below;    ///< [HU], boundary of skin and airway
    float bone_above = SegmentSettings().bone_above;  ///< [HU], boundary of bone
};

struct NamedSurface {
    std::string name;   ///< "skin", "bone" or "airway"
    TriangleMesh mesh;  ///< [m], LPS
    MeshReport report;
};

/// Closed, manifold, outward-oriented surfaces of the labels at sub-voxel positions: where the CT crosses the
/// threshold on the side given by the labels; half-way between voxels that only the labels separate. Without
/// a CT (`ct` null) the labels are blurred by 0.8 voxels and cut at half, which rounds corners and leaves
/// ringing. Structures without voxels are skipped. Throws VolumeError naming surface, fault and location if a
/// surface is invalid, and if CT and labels have different grids.
[[nodiscard]] std::vector<NamedSurface> make_surfaces(const imaging::Mask& labels, const imaging::Volume* ct,
                                                      const SurfaceSettings& settings,
                                                      const Progress& progress);

/// Encodes a binary STL file in millimetres, LPS, as medical programs expect.
[[nodiscard]] imaging::Bytes encode_stl(const TriangleMesh& mesh);

}  // namespace eti::segmentation
