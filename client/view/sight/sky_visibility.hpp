// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti::view {

/// Sky visibility: for each vertex the fraction 0-1 of directions above its surface that the mesh does not
/// block. Outer skin sees most of the sky, the lining of mouth, throat and nose hardly any: this separates
/// mucosa from skin on a single closed surface. Uses height maps of `cell` [m] in `directions` directions;
/// details smaller than two cells are not resolved.
[[nodiscard]] std::vector<float> sky_visibility(const TriangleMesh& mesh, int directions = 48,
                                                float cell = 1.5e-3f);

}  // namespace eti::view
