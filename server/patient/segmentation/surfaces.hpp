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
    std::size_t skin_triangles = 40000;
    std::size_t bone_triangles = 60000;
    std::size_t airway_triangles = 20000;
    /// Passes of Taubin's filter; more takes more of the noise's roughness and of fine detail away.
    int smoothing = 5;
    float air_below = SegmentSettings().air_below;    ///< [HU], where skin and airway end
    float bone_above = SegmentSettings().bone_above;  ///< [HU], where bone ends
};

struct NamedSurface {
    std::string name;   ///< "skin", "bone" or "airway"
    TriangleMesh mesh;  ///< [m], LPS
    MeshReport report;
};

/// Closed, manifold, outward-oriented surfaces of what the labels hold, at sub-voxel places: where the
/// CT crosses the threshold, on the side that the labels tell; half-way where the labels alone part two
/// voxels. Without a CT (`ct` null) the labels are blurred by 0.8 voxels and cut half-way, which rounds
/// and rings. A structure without voxels is left out. Throws VolumeError naming the surface, the
/// fault and its place where one is not sound, and where CT and labels differ in grid.
[[nodiscard]] std::vector<NamedSurface> make_surfaces(const imaging::Mask& labels, const imaging::Volume* ct,
                                                      const SurfaceSettings& settings,
                                                      const Progress& progress);

/// A binary STL file in millimetres, LPS, as medical programs expect.
[[nodiscard]] imaging::Bytes encode_stl(const TriangleMesh& mesh);

}  // namespace eti::segmentation
