// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Unit outward normals, one per vertex: the mean of the adjacent triangles' normals weighted by
/// their areas. A vertex without area around it gets +z.
[[nodiscard]] std::vector<Vec3f> vertex_normals(const TriangleMesh& mesh);

}  // namespace eti
