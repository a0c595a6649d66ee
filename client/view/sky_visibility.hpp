// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti::view {

/// For each vertex the share of directions above its surface in which nothing of the mesh lies, 0-1.
/// Outer skin sees most of the sky, the lining of mouth, throat and nose hardly any: that tells
/// mucosa from skin on a surface that is one closed sheet. By height maps of `cell` [m] in
/// `directions` directions; details smaller than two cells are not resolved.
[[nodiscard]] std::vector<float> sky_visibility(const TriangleMesh& mesh, int directions = 48,
                                                float cell = 1.5e-3f);

}  // namespace eti::view
