// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// What is assumed beyond the outermost nodes of a field.
enum class Border : unsigned char {
    closed,  ///< empty space: a solid that reaches the border is capped there, so the mesh is closed
    open,    ///< unknown: the mesh ends at the border
};

/// The level set `field` = `level`, by marching tetrahedra. Values below `level` are inside; normals point
/// towards increasing values. Every cube is split into the same six tetrahedra around its diagonal
/// (Freudenthal 1942), whose faces match between neighbours. The mesh is therefore manifold, and closed with
/// Border::closed. Vertices keep 2 % of an edge away from the nodes, which avoids degenerate triangles and
/// moves the surface by at most 0.02 sqrt(3) spacings.
[[nodiscard]] TriangleMesh isosurface(const DistanceGrid& field, float level, Border border = Border::closed);

}  // namespace eti
