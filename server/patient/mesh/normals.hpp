// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Unit outward normals, one per vertex: the area-weighted mean of the adjacent triangles' normals. A vertex
/// without adjacent area gets +z.
[[nodiscard]] std::vector<Vec3f> vertex_normals(const TriangleMesh& mesh);

}  // namespace eti
