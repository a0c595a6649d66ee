// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Signed distance to the zero set of `field`, which need not be a distance itself; negative where the field
/// is. Values are limited to +-`band` [m]. The zero set is triangulated by marching tetrahedra: for a surface
/// of curvature k the error is about k spacing^2 / 4 where the field is smooth. A solid that reaches the
/// border has no surface there. The cost grows with the surface's area times the band.
[[nodiscard]] DistanceGrid redistance(const DistanceGrid& field, float band);

/// Signed distance, limited to +-`band` [m], to a closed mesh, at the nodes of a grid with the given origin
/// [m], spacing [m] and size. A point is inside where a ray crosses the mesh an odd number of times.
[[nodiscard]] DistanceGrid mesh_distance(const TriangleMesh& mesh, const Vec3f& origin, float spacing,
                                         const std::array<int, 3>& size, float band);

}  // namespace eti
